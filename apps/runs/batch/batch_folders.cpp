#include "apps/runs/batch/batch_folders.hpp"

#include <system_error>

#include "apps/results/summary.hpp"
#include "apps/runs/batch/batch_table.hpp"
#include "apps/runs/running.hpp"
#include "io/bytes.hpp"
#include "io/file_error.hpp"

namespace wheeltap::apps {
namespace {

namespace fs = std::filesystem;

constexpr int kFormat = 1;

/// Resolves symbolic links in the existing part of a path.
fs::path whole_path(const fs::path& path) {
  std::error_code error;
  fs::path out = fs::weakly_canonical(fs::absolute(path, error), error);
  return error ? path.lexically_normal() : out;
}

}  // namespace

BatchFolders::BatchFolders(fs::path folder, bool resume)
    : folder_(std::move(folder)), taken_{kBatchTable, kBatchFolders} {
  const fs::path path = folder_ / kBatchFolders;
  if (!fs::exists(path)) return;
  const io::FileError not_ours(
      io::FileError::Kind::foreign, path,
      "exists already and is not the list of folders of a batch; remove it "
      "or choose another folder");
  const Report kept = Report::parse(io::read_bytes(path), nullptr, false);
  try {
    if (kept.at("format") != kFormat) throw not_ours;
    for (const Report& one : kept.at("folders")) {
      const auto name = one.at("folder").get<std::string>();
      if (!resume) continue;
      of_[one.at("case").get<std::string>()].push_back(name);
      taken_.insert(name);
    }
  } catch (const Report::exception&) {
    throw not_ours;
  }
}

std::string BatchFolders::place_of(const fs::path& path) const {
  const fs::path from = whole_path(folder_), to = whole_path(path);
  const fs::path relative = to.lexically_relative(from);
  return (relative.empty() ? to : relative).string();
}

std::string BatchFolders::new_name(const fs::path& path) {
  std::string stem = path.stem().string();
  if (stem.empty() || stem == "." || stem == "..") stem = "case";
  if (taken_.insert(stem).second) return stem;
  // Continue after the last number appended to this name, because many cases may have the same
  // name.
  for (int& n = last_.try_emplace(stem, 1).first->second;;) {
    std::string name = stem + "-" + std::to_string(++n);
    if (taken_.insert(name).second) return name;
  }
}

void BatchFolders::give(BatchCase& one) {
  one.place = place_of(one.path);
  std::vector<std::string>& folders = of_[one.place];
  const std::size_t at = given_[one.place]++;
  if (at == folders.size()) folders.push_back(new_name(one.path));
  one.name = folders[at];
}

void BatchFolders::keep() const {
  Report folders = Report::array();
  for (const auto& [place, names] : of_)
    for (const std::string& name : names) folders.push_back({{"case", place}, {"folder", name}});
  write_text(folder_ / kBatchFolders, Report{{"format", kFormat}, {"folders", folders}}.dump(
                                          1, ' ', false, Report::error_handler_t::replace) +
                                          "\n");
}

}  // namespace wheeltap::apps
