// The files of the application's page, from apps/application/page, compiled into the program.
#pragma once

#include <span>
#include <string_view>

namespace wheeltap::apps {

struct PageFile {
  std::string_view name;  ///< name of the file in the URL; empty: the page itself
  std::string_view type;  ///< media type of the file
  std::string_view text;
};

[[nodiscard]] std::span<const PageFile> page_files();

}  // namespace wheeltap::apps
