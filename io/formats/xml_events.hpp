// The elements of an XML document, one after the other (through expat).
#pragma once

#include <functional>
#include <map>
#include <string>
#include <string_view>

namespace wheeltap::io {

/// What is called while a document is read. Names are without their namespace's prefix.
struct XmlEvents {
  std::function<void(const std::string& name, const std::map<std::string, std::string>& attributes)>
      begin;
  std::function<void(const std::string& name)> end;
  std::function<void(std::string_view text)> text;  ///< pieces of what stands between
};

/// Reads a document. Returns why it is none, empty where it is one. Documents with a DOCTYPE, which
/// could expand without bound, are none. Exceptions of `events` pass through.
[[nodiscard]] std::string read_xml(std::string_view document, const XmlEvents& events);

}  // namespace wheeltap::io
