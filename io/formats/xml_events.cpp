#include "io/formats/xml_events.hpp"

#include <expat.h>

#include <algorithm>
#include <exception>
#include <memory>
#include <new>
#include <type_traits>

namespace wheeltap::io {
namespace {

std::string local(std::string_view name) {
  const std::size_t colon = name.rfind(':');
  return std::string(colon == std::string_view::npos ? name : name.substr(colon + 1));
}

/// Stores an exception while control returns through expat, which is C code.
struct Reading {
  const XmlEvents& events;
  XML_Parser parser;
  std::exception_ptr thrown = nullptr;
  bool has_doctype = false;

  template <class Call>
  void guarded(const Call& call) {
    if (thrown) return;
    try {
      call();
    } catch (...) {
      thrown = std::current_exception();
      XML_StopParser(parser, XML_FALSE);
    }
  }
};

void begin(void* data, const XML_Char* name, const XML_Char** attributes) {
  auto& reading = *static_cast<Reading*>(data);
  reading.guarded([&] {
    std::map<std::string, std::string> all;
    for (; attributes[0] != nullptr; attributes += 2) all[local(attributes[0])] = attributes[1];
    reading.events.begin(local(name), all);
  });
}

void end(void* data, const XML_Char* name) {
  auto& reading = *static_cast<Reading*>(data);
  reading.guarded([&] { reading.events.end(local(name)); });
}

void read_text(void* data, const XML_Char* characters, int length) {
  auto& reading = *static_cast<Reading*>(data);
  reading.guarded([&] { reading.events.text({characters, static_cast<std::size_t>(length)}); });
}

void doctype(void* data, const XML_Char*, const XML_Char*, const XML_Char*, int) {
  auto& reading = *static_cast<Reading*>(data);
  reading.has_doctype = true;
  XML_StopParser(reading.parser, XML_FALSE);
}

}  // namespace

std::string read_xml(std::string_view document, const XmlEvents& events) {
  const std::unique_ptr<std::remove_pointer_t<XML_Parser>, void (*)(XML_Parser)> parser(
      XML_ParserCreate(nullptr), XML_ParserFree);
  if (!parser) throw std::bad_alloc();
  Reading reading{.events = events, .parser = parser.get()};
  XML_SetUserData(parser.get(), &reading);
  XML_SetElementHandler(parser.get(), begin, end);
  XML_SetCharacterDataHandler(parser.get(), read_text);
  XML_SetStartDoctypeDeclHandler(parser.get(), doctype);
  constexpr std::size_t kPiece = 1U << 24U;
  XML_Status status = XML_STATUS_OK;
  do {
    const std::string_view piece = document.substr(0, kPiece);
    document.remove_prefix(piece.size());
    status = XML_Parse(parser.get(), piece.data(), static_cast<int>(piece.size()),
                       document.empty() ? 1 : 0);
  } while (status == XML_STATUS_OK && !document.empty());
  if (reading.thrown) std::rethrow_exception(reading.thrown);
  if (reading.has_doctype) return "it has a DOCTYPE, which spreadsheet programs do not write";
  if (status == XML_STATUS_OK) return {};
  return std::string(XML_ErrorString(XML_GetErrorCode(parser.get()))) + " in line " +
         std::to_string(XML_GetCurrentLineNumber(parser.get()));
}

}  // namespace wheeltap::io
