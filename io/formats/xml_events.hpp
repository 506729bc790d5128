// Reads the elements of an XML document in order (through expat).
#pragma once

#include <functional>
#include <map>
#include <string>
#include <string_view>

namespace wheeltap::io {

/// Callbacks while reading a document. Element names are passed without their namespace prefix.
struct XmlEvents {
  std::function<void(const std::string& name, const std::map<std::string, std::string>& attributes)>
      begin;
  std::function<void(const std::string& name)> end;
  std::function<void(std::string_view text)> text;  ///< pieces of the text between tags
};

/// Reads a document. Returns the reason if it is invalid, otherwise an empty text. Documents with a
/// DOCTYPE are invalid, because entities could expand without bound. Exceptions of `events` are
/// rethrown.
[[nodiscard]] std::string read_xml(std::string_view document, const XmlEvents& events);

}  // namespace wheeltap::io
