// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <pugixml.hpp>
#include <string>
#include <vector>

#include "baker/mesh/mesh.h"

namespace spherechain::baker {

// The name of an XML file's outermost element; empty where it is no XML.
std::string xml_root_name(const std::filesystem::path& path);

// An XML file in memory. Entities other than XML's own are not replaced.
class XmlFile {
 public:
  explicit XmlFile(const std::filesystem::path& path);  // throws Error(kFile)
  pugi::xml_node root() const { return document_.document_element(); }
  [[noreturn]] void fail(const std::string& what) const;  // throws Error(kFile): the file, and what is wrong

  // An attribute's numbers, apart by spaces; none where there is no attribute. Fails where they are not finite, or not
  // as many as from `least` to `most`.
  std::vector<double> numbers(pugi::xml_attribute attribute, std::size_t least, std::size_t most) const;
  std::optional<double> number(pugi::xml_attribute attribute) const;
  std::optional<Vec3> vector(pugi::xml_attribute attribute) const;

 private:
  std::string name_;
  pugi::xml_document document_;
};

// An element as messages call it: its tag, and its name where it has one.
std::string in_words(pugi::xml_node element);

}  // namespace spherechain::baker
