// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace spherechain::baker {

bool is_error_stream_terminal();

// Makes a standard stream that is closed read and write nothing: the next file that is opened would else take its
// place. Printing to it then fails, so that lost output is not taken for success.
void open_standard_streams();

// A file that may not grow becomes one that cannot be written, instead of a signal.
void ignore_file_size_signal();

}  // namespace spherechain::baker
