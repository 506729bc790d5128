// Universal files: the datasets of nodes, lines, elements and coordinate systems.
#include "io/universal/universal_reader.hpp"

namespace wheeltap::io::universal {

void read_double_nodes(Reader& in, std::vector<UniversalNode>& out) {
  while (!in.done() && !in.at_separator()) {
    const std::string_view line = in.next("a node");
    if (trimmed(line).empty()) continue;
    const std::vector<int> head = in.integers(line, 10, "number of a node");
    if (head.size() < 4) in.fail("has " + std::to_string(head.size()) + " numbers: must have 4");
    const std::vector<double> at = in.numbers(3, {25}, "coordinates");
    out.push_back({.label = head[0],
                   .definition = head[1],
                   .displacement = head[2],
                   .colour = head[3],
                   .at = {at[0], at[1], at[2]},
                   .is_double = true});
  }
}

void read_elements(Reader& in, std::vector<UniversalElement>& out) {
  while (!in.done() && !in.at_separator()) {
    const std::string_view line = in.next("an element");
    if (trimmed(line).empty()) continue;
    const std::vector<int> head = in.integers(line, 10, "number of an element");
    if (head.size() < 6) in.fail("has " + std::to_string(head.size()) + " numbers: must have 6");
    UniversalElement element{.label = head[0],
                             .descriptor = head[1],
                             .physical = head[2],
                             .material = head[3],
                             .colour = head[4]};
    const int count = head[5];
    if (count < 0) in.fail("a negative number of nodes");
    if (element.is_beam()) {
      const std::vector<int> beam = in.integers(in.next("a beam's sections"), 10, "number");
      for (std::size_t k = 0; k < std::min<std::size_t>(3, beam.size()); ++k)
        element.beam[k] = beam[k];
    }
    while (element.nodes.size() < static_cast<std::size_t>(count)) {
      if (in.done() || in.at_separator())
        in.fail("only " + std::to_string(element.nodes.size()) + " of " + std::to_string(count) +
                " nodes are there");
      for (const int node : in.integers(in.next("nodes"), 10, "node"))
        element.nodes.push_back(node);
    }
    if (element.nodes.size() > static_cast<std::size_t>(count))
      in.fail("more nodes than the " + std::to_string(count) + " of the element");
    out.push_back(std::move(element));
  }
}

void read_systems(Reader& in, std::vector<UniversalSystem>& out) {
  static_cast<void>(in.next("the part's number"));
  static_cast<void>(in.next("the part's name"));
  while (!in.done() && !in.at_separator()) {
    const std::string_view line = in.next("a coordinate system");
    if (trimmed(line).empty()) continue;
    UniversalSystem system{.label = in.integer(field(line, 0, 10), "coordinate system"),
                           .kind = in.integer(field(line, 10, 10), "kind of coordinate system"),
                           .colour = in.integer(field(line, 20, 10), "colour")};
    if (system.kind < 0 || system.kind > 2)
      in.fail("kind of coordinate system " + std::to_string(system.kind) +
              ": must be 0 (Cartesian), 1 (cylindrical) or 2 (spherical)");
    system.name = text_of(in.next("the coordinate system's name"));
    for (std::array<double, 3>& row : system.axes) {
      const std::vector<double> values = in.numbers(3, {25}, "numbers of a coordinate system");
      std::ranges::copy(values, row.begin());
    }
    out.push_back(std::move(system));
  }
}

void read_nodes(Reader& in, std::vector<UniversalNode>& out) {
  while (!in.done() && !in.at_separator()) {
    const std::string_view line = in.next("a node");
    if (trimmed(line).empty()) continue;
    UniversalNode node{.label = in.integer(field(line, 0, 10), "node"),
                       .definition = in.integer(field(line, 10, 10), "coordinate system"),
                       .displacement = in.integer(field(line, 20, 10), "coordinate system"),
                       .colour = in.integer(field(line, 30, 10), "colour")};
    for (std::size_t k = 0; k < 3; ++k)
      node.at[k] = in.number(field(line, 40 + 13 * k, 13), "coordinate");
    out.push_back(node);
  }
}

void read_traces(Reader& in, std::vector<UniversalTrace>& out) {
  while (!in.done() && !in.at_separator()) {
    const std::string_view line = in.next("a trace line");
    if (trimmed(line).empty()) continue;
    UniversalTrace trace{.number = in.integer(field(line, 0, 10), "trace line"),
                         .colour = in.integer(field(line, 20, 10), "colour")};
    const int count = in.integer(field(line, 10, 10), "number of nodes");
    if (count < 0) in.fail("a negative number of nodes");
    trace.id = text_of(in.next("the trace line's name"));
    while (trace.nodes.size() < static_cast<std::size_t>(count)) {
      if (in.done() || in.at_separator())
        in.fail("only " + std::to_string(trace.nodes.size()) + " of " + std::to_string(count) +
                " nodes are there");
      for (const int node : in.integers(in.next("nodes"), 10, "node")) {
        if (node < 0) in.fail("node " + std::to_string(node) + ": must not be negative");
        if (trace.nodes.size() < static_cast<std::size_t>(count))
          trace.nodes.push_back(node);
        else if (node != 0)  // zeros fill the line
          in.fail("more nodes than the " + std::to_string(count) + " of the trace line");
      }
    }
    out.push_back(std::move(trace));
  }
}

}  // namespace wheeltap::io::universal
