#include "json_array.h"

#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>

namespace move_base_abstract {
namespace {

using Json = nlohmann::json;

constexpr int kDeepestNesting = 100;  // readers of logs may recurse

/** @brief Checks the depth only. A handler that returns false ends the parse. */
class DepthCheck : public nlohmann::json_sax<Json> {
 public:
  bool null() override { return true; }
  bool boolean(bool) override { return true; }
  bool number_integer(number_integer_t) override { return true; }
  bool number_unsigned(number_unsigned_t) override { return true; }
  bool number_float(number_float_t, const string_t&) override { return true; }
  bool string(string_t&) override { return true; }
  bool binary(binary_t&) override { return true; }
  bool key(string_t&) override { return true; }
  bool start_object(std::size_t) override { return ++depth_ <= kDeepestNesting; }
  bool end_object() override { return leave(); }
  bool start_array(std::size_t) override { return ++depth_ <= kDeepestNesting; }
  bool end_array() override { return leave(); }
  bool parse_error(std::size_t, const std::string&, const Json::exception&) override {
    return false;
  }

 private:
  bool leave() {
    --depth_;
    return true;
  }

  int depth_ = 0;
};

}  // namespace

bool isJsonArray(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(" \t\n\r");
  // The parser takes a zero byte for the end of the text.
  if (begin == std::string_view::npos || text[begin] != '[' ||
      text.find('\0') != std::string_view::npos) {
    return false;
  }
  DepthCheck check;
  return Json::sax_parse(text.begin(), text.end(), &check);
}

}  // namespace move_base_abstract
