#include "apps/application/app_folder.hpp"

#include <algorithm>
#include <system_error>

#include "apps/failure.hpp"
#include "io/text/text.hpp"

namespace wheeltap::apps {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLongestName = 1024;  // bytes

}  // namespace

AppFolder::AppFolder(const fs::path& root) {
  std::error_code error;
  root_ = fs::canonical(root, error);
  if (error || !fs::is_directory(root_, error))
    throw Failure(Exit::no_input, io::printable(root.string()) +
                                      ": is not a folder: name the folder that holds your cases");
}

bool AppFolder::contains(const fs::path& path) const {
  std::error_code error;
  const fs::path real = fs::weakly_canonical(path, error);
  if (error) return false;
  const auto [own, other] = std::ranges::mismatch(root_, real);
  return own == root_.end();
}

std::optional<fs::path> AppFolder::place(const std::string& name) const {
  if (name.empty() || name.size() > kLongestName || io::first_unprintable(name)) return {};
  if (name.find('\\') != std::string::npos) return {};  // separates folders on other systems
  const fs::path relative(name);
  if (relative.is_absolute()) return {};
  for (const fs::path& part : relative)
    if (part.empty() || part.string().starts_with('.')) return {};
  fs::path path = root_ / relative;
  if (!contains(path)) return {};
  return path;
}

std::string AppFolder::name_of(const fs::path& path) const {
  return path.lexically_relative(root_).generic_string();
}

}  // namespace wheeltap::apps
