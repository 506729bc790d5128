#include "apps/cases/syntax/input_files.hpp"

#include <system_error>

#include "io/file_error.hpp"

namespace wheeltap::apps {

void InputFiles::add(const std::string& name, const std::filesystem::path& path) {
  std::error_code ignored;
  if (files_.contains(name) || !std::filesystem::is_regular_file(path, ignored)) return;
  try {
    auto known = read_->find(path);
    if (known == read_->end()) known = read_->emplace(path, io::fingerprint_of_file(path)).first;
    files_.emplace(name, known->second);
  } catch (const io::FileError&) {  // the function that reads the file reports it
  }
}

InputFiles InputFiles::emptied() const {
  InputFiles out;
  out.read_ = read_;
  return out;
}

nlohmann::json InputFiles::json() const {
  nlohmann::json out = nlohmann::json::object();
  for (const auto& [name, content] : files_)
    out[name] = {{"bytes", content.bytes}, {"checksum", content.digits}};
  return out;
}

}  // namespace wheeltap::apps
