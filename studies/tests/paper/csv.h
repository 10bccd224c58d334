// SPDX-License-Identifier: GPL-3.0-or-later
// The run's CSV files, read without the code that wrote them.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

using Row = std::map<std::string, std::string>;

std::string read_output(const std::string& file);
std::vector<Row> read_csv(const std::string& file);

double number(const Row& row, const std::string& column);
std::vector<double> numbers(const std::vector<Row>& rows, const std::string& column);
std::vector<Row> only(const std::vector<Row>& rows, const std::string& column, const std::string& word);
