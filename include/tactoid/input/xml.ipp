#pragma once

#include <tactoid/core/compiled.hpp>
#include <tactoid/input/xml.hpp>

namespace tactoid::detail {

TACTOID_INLINE XmlElement XmlScanner::root() {
  if (content_.starts_with("\xEF\xBB\xBF")) at_ = 3;
  skip_remarks();
  if (!content_.substr(at_).starts_with('<'))
    throw FileError(fmt::format("{} is no XML file: it does not begin with an element.", name_));
  return element(0);
}

TACTOID_INLINE std::size_t XmlScanner::line() {
  line_ += static_cast<std::size_t>(std::count(content_.begin() + static_cast<std::ptrdiff_t>(counted_),
                                               content_.begin() + static_cast<std::ptrdiff_t>(at_), '\n'));
  counted_ = at_;
  return line_;
}

TACTOID_INLINE void XmlScanner::skip_remarks() {
  for (;;) {
    skip_space();
    const std::string_view rest = content_.substr(at_);
    const std::string_view end = rest.starts_with("<!--") ? "-->" : rest.starts_with("<?") ? "?>" : "";
    if (end.empty()) return;
    const std::size_t found = content_.find(end, at_);
    if (found == std::string_view::npos) refuse("a comment or an instruction is not closed.");
    at_ = found + end.size();
  }
}

TACTOID_INLINE XmlElement XmlScanner::element(int depth) {
  if (depth > 30) refuse("elements are nested too deeply.");
  XmlElement e;
  e.line = line();
  ++at_;
  e.name = word();
  if (e.name.empty()) refuse("the name of an element is expected after \"<\".");
  for (skip_space(); at_ < content_.size() && content_[at_] != '>' && content_[at_] != '/'; skip_space())
    e.attributes.push_back(attribute(e));
  if (content_.substr(at_).starts_with("/>")) {
    at_ += 2;
    return e;
  }
  if (at_ >= content_.size()) refuse_end(e.name);
  if (content_[at_] != '>') refuse(fmt::format("<{}> is not closed by \">\".", e.name));
  ++at_;
  if (e.name == "AppendedData") {
    const std::size_t end = content_.rfind("</AppendedData>");
    if (end == std::string_view::npos || end < at_) refuse("the file ends before </AppendedData>.");
    e.text = content_.substr(at_, end - at_);
    at_ = end + std::string_view("</AppendedData>").size();
    return e;
  }
  for (;;) {
    const std::size_t next = content_.find('<', at_);
    if (next == std::string_view::npos) at_ = content_.size(), refuse_end(e.name);
    if (e.text.empty()) e.text = trimmed(content_.substr(at_, next - at_));
    at_ = next;
    const std::string_view rest = content_.substr(at_);
    if (rest.starts_with("<!--") || rest.starts_with("<?")) {
      skip_remarks();
    } else if (rest.starts_with("</")) {
      at_ += 2;
      const std::string_view closed = word();
      if (closed != e.name) refuse(fmt::format("</{}> is expected, not </{}>.", e.name, closed));
      skip_space();
      if (!content_.substr(at_).starts_with('>')) refuse_end(e.name);
      ++at_;
      return e;
    } else {
      e.children.push_back(element(depth + 1));
    }
  }
}

TACTOID_INLINE std::pair<std::string, std::string> XmlScanner::attribute(const XmlElement& e) {
  std::string key(word());
  skip_space();
  if (key.empty() || !content_.substr(at_).starts_with('='))
    refuse(fmt::format("an attribute of <{}> is expected here, name=\"value\".", e.name));
  ++at_;
  skip_space();
  const char quote = at_ < content_.size() ? content_[at_] : '\0';
  const std::size_t end = quote == '"' || quote == '\'' ? content_.find(quote, at_ + 1) : std::string_view::npos;
  if (end == std::string_view::npos)
    refuse(fmt::format("the value of the attribute {} of <{}> is not in quotation marks.", key, e.name));
  if (e.attribute(key) != nullptr) refuse(fmt::format("the attribute {} of <{}> is there twice.", key, e.name));
  const std::string_view raw = content_.substr(at_ + 1, end - at_ - 1);
  at_ = end + 1;
  std::string value;
  for (std::size_t k = 0; k < raw.size(); ++k) {
    static constexpr std::array<std::pair<std::string_view, char>, 5> entities = {
        {{"&lt;", '<'}, {"&gt;", '>'}, {"&amp;", '&'}, {"&quot;", '"'}, {"&apos;", '\''}}};
    const auto found = std::find_if(entities.begin(), entities.end(),
                                    [&](const auto& entity) { return raw.substr(k).starts_with(entity.first); });
    value += found == entities.end() ? raw[k] : found->second;
    if (found != entities.end()) k += found->first.size() - 1;
  }
  return {std::move(key), std::move(value)};
}

}  // namespace tactoid::detail
