// /inputs of a run file: the files that a run read and the parts that it loaded, exactly as they were.
#pragma once

#include <hdf5.h>

#include <vector>

#include "engine/record/run_file.hpp"

namespace verisim {

/// Throw hdf5::Failure.
void write_inputs(hid_t file, const std::vector<InputFile>& files, const std::vector<StoredModel>& models);
[[nodiscard]] std::vector<InputFile> read_input_files(hid_t file);
[[nodiscard]] std::vector<StoredModel> read_input_models(hid_t file);

}  // namespace verisim
