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

  [[nodiscard]] XmlElement root();

  [[noreturn]] void refuse(std::size_t line, std::string_view what) const {
    throw FileError(fmt::format("{}, line {}: {}", name_, line, what));
  }

 private:
  [[nodiscard]] std::size_t line();
  [[noreturn]] void refuse(std::string_view what) { refuse(line(), what); }
  [[noreturn]] void refuse_end(std::string_view name) { refuse(fmt::format("the file ends inside <{}>.", name)); }

  void skip_space() { at_ = std::min(content_.find_first_not_of(" \t\r\n", at_), content_.size()); }
  /// Blanks, comments and <? … ?>.
  void skip_remarks();
  [[nodiscard]] std::string_view word() {
    const std::size_t begin = at_;
    at_ = std::min(content_.find_first_of(" \t\r\n=/><\"'", at_), content_.size());
    return content_.substr(begin, at_ - begin);
  }

  XmlElement element(int depth);

  std::pair<std::string, std::string> attribute(const XmlElement& e);

  std::string name_;
  std::string_view content_;
  std::size_t at_ = 0, line_ = 1, counted_ = 0;
};

}  // namespace tactoid::detail

#if !defined(TACTOID_COMPILED)
#include <tactoid/input/xml.ipp>
#endif
