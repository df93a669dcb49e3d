#pragma once

#include <tactoid/core/compiled.hpp>
#include <tactoid/output/summary.hpp>

namespace tactoid {

TACTOID_INLINE std::string Summary::json(int indent) const {
  if (members_.empty()) return "{}";
  const std::string margin(static_cast<std::size_t>(indent), ' ');
  std::string text = "{";
  for (std::size_t i = 0; i < members_.size(); ++i) {
    text += fmt::format("{}\n{}  {}: ", i == 0 ? "" : ",", margin, to_json(members_[i].first));
    for (const char c : members_[i].second) {  // nested objects move with their margin
      text += c;
      if (c == '\n') text += margin + "  ";
    }
  }
  return text + '\n' + margin + '}';
}

TACTOID_INLINE std::string Summary::to_json(std::string_view text) {
  std::string result = "\"";
  while (!text.empty()) {
    const std::size_t length = utf8_sequence_length(text);
    const auto byte = static_cast<unsigned char>(text[0]);
    if (length == 0)
      result += "\xEF\xBF\xBD";
    else if (text[0] == '"' || text[0] == '\\')
      result += {'\\', text[0]};
    else if (byte < 0x20)
      result += fmt::format("\\u{:04x}", byte);
    else
      result += text.substr(0, length);
    text.remove_prefix(length == 0 ? 1 : length);
  }
  return result + '"';
}

}  // namespace tactoid
