#pragma once

// The parts of nlohmann-json that most tests use, compiled once: in json_fields.cpp of the library
// and in compiled_json.cpp.

#include <hshfit/files/json_fields.h>

namespace hshfit::test {
using TextAdapter = nlohmann::detail::iterator_input_adapter<std::string::const_iterator>;
using StreamAdapter = nlohmann::detail::input_stream_adapter;
}  // namespace hshfit::test

namespace nlohmann::detail {
extern template class serializer<json>;
extern template class json_sax_dom_parser<json>;
extern template class json_sax_dom_callback_parser<json>;
extern template class lexer<json, hshfit::test::TextAdapter>;
extern template class parser<json, hshfit::test::TextAdapter>;
extern template class lexer<json, hshfit::test::StreamAdapter>;
extern template class parser<json, hshfit::test::StreamAdapter>;
extern template class iter_impl<const json>;
}  // namespace nlohmann::detail
