#include "compiled_json.h"

namespace nlohmann::detail {
template class serializer<json>;
template class json_sax_dom_parser<json>;
template class json_sax_dom_callback_parser<json>;
template class lexer<json, hshfit::test::TextAdapter>;
template class parser<json, hshfit::test::TextAdapter>;
template class lexer<json, hshfit::test::StreamAdapter>;
template class parser<json, hshfit::test::StreamAdapter>;
template class iter_impl<const json>;
}  // namespace nlohmann::detail
