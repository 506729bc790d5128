// wheeltap: the command line.
#include <string>
#include <string_view>

#include "apps/cli/restart.hpp"
#include "apps/cli/run_program.hpp"
#include "apps/commands/command_list.hpp"

namespace {

using namespace wheeltap;

// Applies --simd before the command line is parsed.
void apply_simd(int argc, char** argv) {
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    constexpr std::string_view kOption = "--simd";
    std::string value;
    if (word == kOption && i + 1 < argc) value = argv[i + 1];
    if (word.starts_with(std::string(kOption) + "=")) value = word.substr(kOption.size() + 1);
    if (value == "baseline" || value == "avx2" || value == "avx512")
      apps::restart_with(value, argv);
  }
}

}  // namespace

int main(int argc, char** argv) {
  apply_simd(argc, argv);
  return apps::run_program(apps::commands(), argc, argv);
}
