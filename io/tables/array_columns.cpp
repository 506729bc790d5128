#include "io/tables/array_columns.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <utility>

namespace wheeltap::io {
namespace {

constexpr std::size_t kMostChannels = 10'000;  // largest number of channels of one array

bool is_vector(const ArrayShape& array) {
  return std::ranges::count_if(array.shape, [](std::size_t d) { return d != 1; }) <= 1;
}

/// Returns the dimension of the array along which a channel of this length lies, or std::nullopt if
/// the array has no channel of this length.
std::optional<std::size_t> along(const ArrayShape& array, const ArrayLayout& layout,
                                 std::size_t length) {
  if (array.size() <= 1) return {};
  std::size_t from = 0, to = array.shape.size();
  if (layout.rows_are_channels && !is_vector(array)) {
    if (*layout.rows_are_channels) from = to - 1;
    to = from + 1;
  }
  for (std::size_t k = from; k < to; ++k)
    if (array.shape[k] == length) return k;
  return {};
}

/// The length of the channels of an array; 0 for a single number.
std::size_t length_of(const ArrayShape& array, const ArrayLayout& layout) {
  if (array.size() <= 1) return 0;
  if (layout.rows_are_channels && !is_vector(array))
    return *layout.rows_are_channels ? array.shape.back() : array.shape.front();
  return std::ranges::max(array.shape);
}

/// The possible channel lengths of the arrays, sorted by decreasing number of values.
std::vector<std::size_t> lengths_of(std::span<const ArrayShape> arrays, const ArrayLayout& layout) {
  std::map<std::size_t, std::size_t> counts;
  for (const ArrayShape& a : arrays)
    if (const std::size_t length = length_of(a, layout); length > 1) counts[length] += a.size();
  std::vector<std::pair<std::size_t, std::size_t>> order;
  for (const auto& [length, count] : counts) order.emplace_back(count, length);
  std::ranges::sort(order, std::greater());
  std::vector<std::size_t> out;
  for (const auto& [count, length] : order) out.push_back(length);
  return out;
}

/// Inserts an index into the name of a column: "X, real" becomes "X(:,2), real".
std::string indexed(const std::string& name, const std::string& index) {
  const std::size_t part = std::min(name.find(", "), name.size());
  return name.substr(0, part) + index + name.substr(part);
}

/// Distance in storage of two elements with successive indices, per dimension.
std::vector<std::size_t> strides_of(const ArrayShape& array) {
  std::vector<std::size_t> out(array.shape.size(), 1);
  const auto n = out.size();
  for (std::size_t i = 1; i < n; ++i)
    if (array.row_major)
      out[n - 1 - i] = out[n - i] * array.shape[n - i];
    else
      out[i] = out[i - 1] * array.shape[i - 1];
  return out;
}

std::size_t channels_of(const ArrayShape& array, std::size_t length) {
  return array.size() / std::max<std::size_t>(length, 1);
}

void add_channels(const ArrayShape& array, std::size_t number, std::size_t dimension,
                  Columns& table, std::vector<ColumnSource>& sources) {
  const std::vector<std::size_t> strides = strides_of(array);
  const std::size_t channels = channels_of(array, array.shape[dimension]);
  std::vector<std::size_t> index(array.shape.size(), 0);
  for (std::size_t c = 0; c < channels; ++c) {
    std::size_t first = 0;
    std::string text;
    for (std::size_t k = 0; k < index.size(); ++k) {
      text += (text.empty() ? "" : ",") + (k == dimension ? ":" : std::to_string(index[k] + 1));
      first += index[k] * strides[k];
    }
    std::string name = channels == 1 ? array.name : indexed(array.name, "(" + text + ")");
    table.columns.push_back({.header = array.unit.empty() ? name : name + " [" + array.unit + "]",
                             .name = name,
                             .unit = array.unit});
    sources.push_back({.array = number, .first = first, .step = strides[dimension]});
    // The last index varies fastest: H(1,1,:), H(1,2,:), …
    for (std::size_t k = index.size(); k-- > 0;) {
      if (k == dimension) continue;
      if (++index[k] < array.shape[k]) break;
      index[k] = 0;
    }
  }
}

void add_columns(std::span<const ArrayShape> arrays, const ArrayLayout& layout, std::size_t length,
                 Columns& table, std::vector<ColumnSource>& sources) {
  for (std::size_t i = 0; i < arrays.size(); ++i)
    if (const auto dimension = along(arrays[i], layout, length);
        dimension && channels_of(arrays[i], length) <= kMostChannels)
      add_channels(arrays[i], i, *dimension, table, sources);
}

/// Returns the reason why an array is not a channel of the table, and the name that selects the
/// array in a case.
std::string other_length(const ArrayShape& array, const ArrayLayout& layout) {
  const std::string shown = array.name + " (" + array.shape_in_words();
  const std::size_t length = length_of(array, layout);
  if (array.size() == 0) return shown + ", empty)";
  if (length <= 1) return shown + ", one sample per channel)";
  if (channels_of(array, length) > kMostChannels)
    return shown + ", more than " + std::to_string(kMostChannels) + " channels)";
  Columns own;
  std::vector<ColumnSource> sources;
  add_columns(std::span(&array, 1), layout, length, own, sources);
  std::string names = "'" + own.columns.front().name + "'";
  if (own.columns.size() > 1) names += " to '" + own.columns.back().name + "'";
  return shown + ", of another length: to read it, name " + names + " in the case)";
}

}  // namespace

std::size_t ArrayShape::size() const {
  constexpr std::size_t kMost = std::numeric_limits<std::size_t>::max();
  if (std::ranges::count(shape, std::size_t{0}) > 0) return 0;
  std::size_t n = 1;
  for (const std::size_t d : shape) n = n > kMost / d ? kMost : n * d;
  return n;
}

std::string ArrayShape::shape_in_words() const {
  if (shape.size() == 1) return std::to_string(shape[0]) + " x 1";
  std::string out;
  for (const std::size_t d : shape) out += (out.empty() ? "" : " x ") + std::to_string(d);
  return out;
}

ChosenColumns choose_columns(std::span<const ArrayShape> arrays, const ArrayLayout& layout,
                             const Wanted& wanted, Columns& table) {
  ChosenColumns best;
  std::vector<Column> columns;
  std::size_t most = 0;
  for (const std::size_t length : lengths_of(arrays, layout)) {
    table.columns.clear();
    ChosenColumns chosen{.length = length};
    add_columns(arrays, layout, length, table, chosen.sources);
    if (table.columns.empty()) continue;
    std::size_t count = 0;
    for (std::size_t c = 0; wanted && c < table.columns.size(); ++c) count += wanted(table, c);
    const bool all = count == table.columns.size();
    if (columns.empty() || count > most) {
      columns = std::move(table.columns);
      best = std::move(chosen);
      most = count;
    }
    if (!wanted || all) break;
  }
  table.columns = std::move(columns);
  for (const ArrayShape& a : arrays)
    if (a.size() != 1 && (best.length == 0 || !along(a, layout, best.length) ||
                          channels_of(a, best.length) > kMostChannels))
      table.others.push_back(other_length(a, layout));
  return best;
}

void fill_columns(const ChosenColumns& chosen, const Wanted& wanted,
                  const std::function<std::vector<double>(std::size_t array)>& values,
                  Columns& table) {
  std::optional<std::size_t> held;
  std::vector<double> numbers;
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    if (wanted && !wanted(table, c)) continue;
    const ColumnSource& source = chosen.sources[c];
    if (held != source.array) {
      numbers = values(source.array);
      held = source.array;
    }
    std::vector<double>& into = table.columns[c].values;
    into.reserve(chosen.length);
    for (std::size_t i = 0; i < chosen.length; ++i)
      into.push_back(numbers.at(source.first + i * source.step));
  }
}

}  // namespace wheeltap::io
