#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <tactoid/core/errors.hpp>
#include <tactoid/core/text.hpp>

namespace tactoid::detail {

/// An element of an XML file. Its text is the first that is not blank.
struct XmlElement {
  std::string name;
  std::size_t line = 0;
  std::vector<std::pair<std::string, std::string>> attributes;
  std::vector<XmlElement> children;
  std::string_view text;  ///< a part of the file's content

  /// The value of an attribute, or nullptr.
  [[nodiscard]] const std::string* attribute(std::string_view key) const {
    for (const auto& [name_of, value] : attributes)
      if (name_of == key) return &value;
    return nullptr;
  }
  [[nodiscard]] const XmlElement* child(std::string_view key) const {
    const auto found =
        std::find_if(children.begin(), children.end(), [&](const XmlElement& e) { return e.name == key; });
    return found == children.end() ? nullptr : &*found;
  }
};

/// Reads elements, attributes and texts, which is what VTK's files consist of, and one thing that is no XML: the raw
/// bytes in <AppendedData>. What follows them is not read.
class XmlScanner {
 public:
  /// `name` of the file in messages; the content must outlive the elements.
  XmlScanner(std::string name, std::string_view content) : name_(std::move(name)), content_(content) {}

  [[nodiscard]] XmlElement root() {
    if (content_.starts_with("\xEF\xBB\xBF")) at_ = 3;
    skip_remarks();
    if (!content_.substr(at_).starts_with('<'))
      throw FileError(fmt::format("{} is no XML file: it does not begin with an element.", name_));
    return element(0);
  }

  [[noreturn]] void refuse(std::size_t line, std::string_view what) const {
    throw FileError(fmt::format("{}, line {}: {}", name_, line, what));
  }

 private:
  [[nodiscard]] std::size_t line() {
    line_ += static_cast<std::size_t>(std::count(content_.begin() + static_cast<std::ptrdiff_t>(counted_),
                                                 content_.begin() + static_cast<std::ptrdiff_t>(at_), '\n'));
    counted_ = at_;
    return line_;
  }
  [[noreturn]] void refuse(std::string_view what) { refuse(line(), what); }
  [[noreturn]] void refuse_end(std::string_view name) { refuse(fmt::format("the file ends inside <{}>.", name)); }

  void skip_space() { at_ = std::min(content_.find_first_not_of(" \t\r\n", at_), content_.size()); }
  /// Blanks, comments and <? … ?>.
  void skip_remarks() {
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
  [[nodiscard]] std::string_view word() {
    const std::size_t begin = at_;
    at_ = std::min(content_.find_first_of(" \t\r\n=/><\"'", at_), content_.size());
    return content_.substr(begin, at_ - begin);
  }

  XmlElement element(int depth) {
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

  std::pair<std::string, std::string> attribute(const XmlElement& e) {
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

  std::string name_;
  std::string_view content_;
  std::size_t at_ = 0, line_ = 1, counted_ = 0;
};

}  // namespace tactoid::detail
