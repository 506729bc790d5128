// Reading of an XML document with the library expat, element by element in the order of the
// document.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <string_view>

namespace wheeltap::io {

/// Callbacks for the elements of a document. Element names are passed without their namespace
/// prefix.
struct XmlEvents {
  std::function<void(const std::string& name, const std::map<std::string, std::string>& attributes)>
      begin;
  std::function<void(const std::string& name)> end;
  std::function<void(std::string_view text)> text;  ///< parts of the text between tags
};

/// Reads a document. Returns the reason if the document is invalid, otherwise an empty string.
/// Documents with a DOCTYPE are invalid, because their entities could expand without bound.
/// Exceptions of `events` are rethrown.
[[nodiscard]] std::string read_xml(std::string_view document, const XmlEvents& events);

}  // namespace wheeltap::io
