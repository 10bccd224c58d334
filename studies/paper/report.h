// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "claims.h"

namespace spherechain::paper {

// Every table as a CSV file, the figures, and index.html with all of them beside the paper's claims.
void write_page(const std::filesystem::path& folder, const Results& results);

// The same as Markdown; its figures go into a folder beside it, named like the file.
void write_docs(const std::filesystem::path& file, const Results& results);

}  // namespace spherechain::paper
