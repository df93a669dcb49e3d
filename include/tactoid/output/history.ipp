#pragma once

#include <tactoid/core/compiled.hpp>
#include <tactoid/output/history.hpp>

namespace tactoid {

TACTOID_INLINE HistoryWriter::HistoryWriter(std::filesystem::path path, std::vector<std::string> columns,
                                            std::optional<double> keep_until, const std::string& key)
    : path_(std::move(path)), columns_(std::move(columns)) {
  std::string head;
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    const std::string& name = columns_[i];
    if (name.empty() || name.find_first_of(",\"\n\r") != std::string::npos)
      throw ParameterError(fmt::format("HistoryWriter: {} is not allowed as the name of a column.", in_quotes(name)));
    for (std::size_t j = 0; j < i; ++j)
      if (columns_[j] == name)
        throw ParameterError(fmt::format("HistoryWriter: two columns have the name {}.", in_quotes(name)));
    head += (i == 0 ? "" : ",") + name;
  }
  const auto at = key.empty() ? columns_.begin() : std::find(columns_.begin(), columns_.end(), key);
  if (at == columns_.end() && !key.empty())
    throw ParameterError(fmt::format("HistoryWriter: {} is no column of {}.", in_quotes(key), in_quotes(path_.string())));
  if (!is_first_rank()) return;
  // What is kept is never lost: the file is then replaced as a whole.
  if (keep_until) write_file(path_, head + '\n' + lines_until(head, at - columns_.begin(), *keep_until));
  file_.reset(std::fopen(path_.c_str(), keep_until ? "ab" : "wb"));
  if (!file_) detail::fail_file("write", path_, errno);
  std::setvbuf(file_.get(), nullptr, _IONBF, 0);  // nothing of a line that failed waits to be written later
  if (!keep_until) put(head + '\n');
}

TACTOID_INLINE void HistoryWriter::write(std::span<const double> values) {
  if (values.size() != columns_.size()) {
    throw ParameterError(fmt::format("HistoryWriter: {} values were given for the {} columns of {}.", values.size(),
                                     columns_.size(), in_quotes(path_.string())));
  }
  if (!file_) return;
  std::string line;
  for (std::size_t i = 0; i < values.size(); ++i) line += fmt::format("{}{}", i == 0 ? "" : ",", values[i]);
  put(line + '\n');
}

TACTOID_INLINE std::string HistoryWriter::lines_until(const std::string& head, std::ptrdiff_t column,
                                                      double last) const {
  std::error_code none;
  if (!std::filesystem::exists(path_, none) || std::filesystem::file_size(path_, none) == 0) return "";
  std::ifstream file(path_, std::ios::binary);
  if (!file) detail::fail_file("read", path_, errno);
  std::string line, kept;
  if (!std::getline(file, line) || line != head)
    throw ParameterError(fmt::format("HistoryWriter: {} has other columns, and cannot be continued.", in_quotes(path_.string())));
  while (std::getline(file, line) && !file.eof()) {  // a line without its end was cut off
    const char *at = line.data(), *const end = at + line.size();
    for (std::ptrdiff_t c = 0; c < column; ++c) {
      at = std::find(at, end, ',');
      if (at != end) ++at;
    }
    double value = 0.0;
    if (std::from_chars(at, end, value).ec != std::errc{} || value > last) break;
    kept += line + '\n';
  }
  return kept;
}

TACTOID_INLINE void HistoryWriter::put(const std::string& line) {
  const int descriptor = ::fileno(file_.get());
  struct ::stat before {};
  const bool known = ::fstat(descriptor, &before) == 0 && S_ISREG(before.st_mode);
  if (std::fwrite(line.data(), 1, line.size(), file_.get()) == line.size()) return;
  const int error = errno;
  if (known) {
    [[maybe_unused]] const int cut = ::ftruncate(descriptor, before.st_size);  // should it fail, too, a part of a line stays
  }
  detail::fail_file("write", path_, error);
}

}  // namespace tactoid
