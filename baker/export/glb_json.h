// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "baker/import/glb_file.h"

// Changes the JSON of an existing GLB. Every other byte stays.
namespace spherechain::baker {

// Its JSON, members in their order. Throws Error(kInternal) where it has none.
nlohmann::ordered_json json_of_glb(const std::string& bytes);

// The file with other JSON.
std::string with_json(const std::string& bytes, const nlohmann::ordered_json& json);

// An extension of the whole file, which is made where it is missing, and named in extensionsUsed.
nlohmann::ordered_json& use_extension(nlohmann::ordered_json& json, const std::string& name);
void drop_extension(nlohmann::ordered_json& json, const std::string& name);

// An object's array, which is made where it is missing. Then references to the object's other members are void.
nlohmann::ordered_json& array_in(nlohmann::ordered_json& object, const std::string& name);

// True if this tool made a thing: its name begins with kOwnName.
inline constexpr const char* kOwnName = "spherechain ";
bool is_own(const nlohmann::ordered_json& thing);

// Takes entries out of an array. Returns where each went; -1: out.
std::vector<int> take_out(nlohmann::ordered_json& array,
                          const std::function<bool(std::size_t, const nlohmann::ordered_json&)>& is_out);

// Numbers of an array's entries after take_out; those of entries that went are left out. Elements that are no numbers
// stay.
void renumber(nlohmann::ordered_json& numbers, const std::vector<int>& went);

}  // namespace spherechain::baker
