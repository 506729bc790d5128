// What several commands' options are: numbers in a range, and how a text is laid out.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>

namespace wheeltap::io {
struct ArrayLayout;
struct TextLayout;
}  // namespace wheeltap::io

namespace wheeltap::apps {

/// Whole numbers in [lowest, highest], by the one reader of them; what stands for the option is the
/// number's plain form, so that nothing reads it otherwise.
[[nodiscard]] CLI::Validator whole(std::int64_t lowest, std::int64_t highest);

/// Finite numbers above 0.
[[nodiscard]] CLI::Validator positive();

/// Numbers from 0 to 1e9.
[[nodiscard]] CLI::Validator seconds();

/// Adds options for how a text, a workbook or a file of arrays is laid out, named as the keys of a
/// case's record are.
void add_layout(CLI::App* command, io::TextLayout& layout, io::ArrayLayout& arrays);

}  // namespace wheeltap::apps
