#pragma once

#include <algorithm>
#include <charconv>
#include <concepts>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <tactoid/core/errors.hpp>
#include <tactoid/core/quantity.hpp>
#include <tactoid/core/ranks.hpp>
#include <tactoid/core/version.hpp>
#include <tactoid/output/file.hpp>

#include <common/config_file.hpp>
#include <common/info.hpp>
#include <common/nearest_name.hpp>
#include <common/range.hpp>

namespace tactoid {

/// The options of a program, each declared once: name, variable (its value is the default), allowed values, help.
/// They are read from the command line and from a TOML file (`--config FILE.toml`); the command line wins.
///
///     Options options("spreading_uniform", "A cell spreads on a uniform substrate.");
///     options.add("stiffness", &stiffness, Range::positive(), "factor on the base substrate");
///     options.add_quantity("end-time", &end_time, Quantity::time, Range::positive(), "simulated time");
///     options.add_choice("preset", &preset, {"printed", "viscous/10", "elastic"}, "the substrate's viscous
///     constants"); if (!options.parse(argc, argv)) return 0;   // --help or --info was printed …
///     options.write_toml(folder / "parameters.toml");
///
/// Whatever is wrong throws ParameterError (FileError where --config cannot be read) with one sentence, before
/// anything is computed or written. Variables must outlive the object.
class Options {
 public:
  Options(std::string program, std::string purpose) : program_(std::move(program)), purpose_(std::move(purpose)) {}

  /// A plain number.
  void add(std::string name, double* value, Range range, std::string help) {
    add_quantity(std::move(name), value, Quantity::dimensionless, range, std::move(help));
  }

  /// A number with a unit.
  void add_quantity(std::string name, double* value, const Quantity& quantity, Range range, std::string help) {
    Entry entry{.name = std::move(name), .help = std::move(help), .allowed = range.text(quantity)};
    entry.unit = quantity.si();
    entry.type = quantity.units.empty() ? "NUMBER" : fmt::format("NUMBER[{}]", quantity.si());
    entry.shown = format_quantity(*value, quantity);
    entry.read = [value, quantity, range](std::string_view text, std::string_view where) {
      const double number = parse_quantity(text, quantity, where);
      if (!range.contains(number)) {
        throw ParameterError(fmt::format("{} = {} is not allowed: it must be {}.", where,
                                         format_quantity(number, quantity), range.text(quantity)));
      }
      *value = number;
    };
    entry.toml = [value] { return fmt::format("{}", *value); };
    insert(std::move(entry));
  }

  /// A whole number.
  template <std::integral Integer>
    requires(!std::same_as<Integer, bool>)
  void add(std::string name, Integer* value, Range range, std::string help) {
    Entry entry{.name = std::move(name), .help = std::move(help), .allowed = range.text()};
    entry.type = "INTEGER";
    entry.shown = fmt::format("{}", *value);
    entry.read = [value, range](std::string_view text, std::string_view where) {
      std::string_view digits = trimmed(text);
      if (digits.empty()) throw ParameterError(fmt::format("{}: the value is empty; a whole number is needed.", where));
      if (digits.starts_with('+')) digits.remove_prefix(1);
      Integer number{};
      const auto read = std::from_chars(digits.data(), digits.data() + digits.size(), number);
      const bool whole = read.ptr == digits.data() + digits.size();
      if (whole && read.ec == std::errc::result_out_of_range)
        throw ParameterError(fmt::format("{}: {} is outside the range of numbers.", where, in_quotes(text)));
      if (!whole || read.ec != std::errc{})
        throw ParameterError(fmt::format("{}: {} is not a whole number.", where, in_quotes(text)));
      if (!range.contains(static_cast<double>(number))) {
        throw ParameterError(fmt::format("{} = {} is not allowed: it must be {}.", where, number, range.text()));
      }
      *value = number;
    };
    entry.toml = [value] { return fmt::format("{}", *value); };
    insert(std::move(entry));
  }

  /// A text, a path. It may be empty if the default is.
  void add(std::string name, std::string* value, std::string help) {
    Entry entry{.name = std::move(name), .help = std::move(help), .type = "TEXT", .kind = Kind::text};
    entry.shown = *value;
    entry.read = [value, may_be_empty = value->empty()](std::string_view text, std::string_view where) {
      *value = may_be_empty && text.empty() ? "" : checked_text(text, where);
    };
    entry.toml = [value] { return toml_text(*value); };
    insert(std::move(entry));
  }

  /// One of several words.
  void add_choice(std::string name, std::string* value, std::vector<std::string> choices, std::string help) {
    Entry entry{.name = std::move(name), .help = std::move(help), .type = "WORD", .kind = Kind::text};
    std::string list;
    for (const std::string& choice : choices) list += (list.empty() ? "" : ", ") + choice;
    entry.allowed = "one of " + list;
    entry.shown = *value;
    entry.read = [value, choices, list](std::string_view text, std::string_view where) {
      const std::string word = checked_text(text, where);
      if (std::find(choices.begin(), choices.end(), word) == choices.end()) {
        const std::string near = nearest_name(word, choices);
        throw ParameterError(fmt::format("{}: {} is not one of {}{}", where, in_quotes(word), list,
                                         near.empty() ? "." : "; did you mean " + near + "?"));
      }
      *value = word;
    };
    entry.toml = [value] { return toml_text(*value); };
    insert(std::move(entry));
  }

  /// Yes or no: `--name` and `--no-name`; true or false in a file.
  void add(std::string name, bool* value, std::string help) {
    Entry entry{.name = std::move(name), .help = std::move(help), .kind = Kind::truth};
    entry.shown = *value ? "yes" : "no";
    entry.read = [value](std::string_view text, std::string_view where) {
      if (text != "true" && text != "false")
        throw ParameterError(fmt::format("{}: {} is neither true nor false.", where, in_quotes(text)));
      *value = text == "true";
    };
    entry.toml = [value] { return *value ? "true" : "false"; };
    insert(std::move(entry));
  }

  /// An option that names a file which brings options itself, as --config does: `read(file)` gives their text. They come
  /// before those of --config, and these before the command line: the last one wins.
  void add_source(std::string name, std::string type, std::function<std::string(const std::string& file)> read, std::string help) {
    sources_.push_back({std::move(name), std::move(type), std::move(help), std::move(read)});
  }

  /// Reads the command line. False where it asked for --help or --info, which are printed then: the program is done.
  [[nodiscard]] bool parse(int argc, const char* const* argv) {
    return parse(std::vector<std::string>(argv + std::min(argc, 1), argv + argc));
  }
  [[nodiscard]] bool parse(const std::vector<std::string>& arguments) {
    for (const std::string& argument : arguments)
      if (!is_utf8(argument)) throw ParameterError(fmt::format("The argument {} is not UTF-8.", in_quotes(argument)));

    // CLI11 finds the options and their texts; what the texts mean is said by the entries.
    CLI::App app(fmt::format("{}\nUnits may be written behind numbers: 5us, 0.2 nm, 10 kPa.", purpose_), program_);
    app.formatter(std::make_shared<Help>());
    app.set_help_flag("--help,-h", "Print this and exit");
    app.allow_extras();
    bool info = false;
    app.add_flag("--info", info, "Print the versions of the library and of its dependencies, and exit");
    std::vector<std::string> config_files;
    app.add_option("--config", config_files, "Read options from this file: lines `name = value`; the command line wins")
        ->type_name("FILE.toml")
        ->allow_extra_args(false);
    std::vector<std::vector<std::string>> source_files(sources_.size());
    for (std::size_t i = 0; i < sources_.size(); ++i)
      app.add_option("--" + sources_[i].name, source_files[i], sources_[i].help)->type_name(sources_[i].type)->allow_extra_args(false);
    std::vector<std::vector<std::string>> texts(entries_.size());
    std::vector<std::pair<int, int>> flags(entries_.size());
    for (std::size_t i = 0; i < entries_.size(); ++i) {
      const Entry& entry = entries_[i];
      std::string help = entry.help;
      if (!entry.allowed.empty()) help += "; " + entry.allowed;
      help += fmt::format(" [{}]", entry.shown);
      if (entry.kind == Kind::truth) {
        app.add_flag("--" + entry.name, flags[i].first, help);
        app.add_flag("--no-" + entry.name, flags[i].second, "The opposite of --" + entry.name);
      } else {
        app.add_option("--" + entry.name, texts[i], help)->type_name(entry.type)->allow_extra_args(false);
      }
    }
    for (const std::string& argument : arguments)
      if (argument.starts_with("--") && argument.ends_with('=')) throw ParameterError(argument + " needs a value.");
    for (const Entry& entry : entries_) {
      if (entry.kind != Kind::truth) continue;
      for (const std::string& prefix : {"--" + entry.name + "=", "--no-" + entry.name + "="})
        for (const std::string& argument : arguments)
          if (argument.starts_with(prefix))
            throw ParameterError(fmt::format("{} takes no value, but {} is given: write --{} or --no-{}.", prefix.substr(0, prefix.size() - 1),
                                             in_quotes(std::string_view(argument).substr(prefix.size())), entry.name, entry.name));
    }
    try {
      app.parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));
    } catch (const CLI::CallForHelp&) {
      if (is_first_rank()) fmt::print("{}", app.help());
      return false;
    } catch (const CLI::ArgumentMismatch& error) {
      throw ParameterError(fmt::format(
          "{} needs a value.", std::string_view(error.what()).substr(0, std::string_view(error.what()).find(':'))));
    } catch (const CLI::ParseError& error) {
      throw ParameterError(error.what());
    }
    // CLI11 hands over the next argument as the value, whatever it is.
    for (std::size_t i = 0; i < entries_.size(); ++i)
      for (const std::string& text : texts[i])
        if (text.starts_with("--"))
          throw ParameterError(fmt::format("--{} needs a value, but {} follows.", entries_[i].name, text));
    for (const std::string& extra : app.remaining()) refuse(extra);
    if (info) {
      if (is_first_rank()) fmt::print("{}", info_text());
      return false;
    }

    for (std::size_t i = 0; i < sources_.size(); ++i) {
      single("--" + sources_[i].name, source_files[i]);
      for (const std::string& file : source_files[i]) {
        const std::string path = checked_text(file, "--" + sources_[i].name);
        const std::string label = std::filesystem::path(path).filename().string();
        apply(read_config(sources_[i].read(path), label), label);
      }
    }
    single("--config", config_files);
    for (const std::string& file : config_files) {
      const std::string path = checked_text(file, "--config");
      apply(read_config_file(path), std::filesystem::path(path).filename().string());
    }
    for (std::size_t i = 0; i < entries_.size(); ++i) {
      const std::string name = "--" + entries_[i].name;
      single(name, texts[i]);
      for (const std::string& text : texts[i]) entries_[i].read(text, name);
      if (flags[i].first > 0 && flags[i].second > 0)
        throw ParameterError(fmt::format("{0} and --no-{1} contradict each other.", name, entries_[i].name));
      if (flags[i].first + flags[i].second > 0) entries_[i].read(flags[i].first > 0 ? "true" : "false", name);
    }
    return true;
  }

  /// All options with their present values as a TOML file, which --config reads back exactly.
  [[nodiscard]] std::string toml() const {
    std::string text =
        fmt::format("# Parameters of {} (Tactoid {}); use as --config. Numbers are in SI units.\n", program_, version);
    for (const Entry& entry : entries_) {
      text +=
          fmt::format("\n# {}{}{}\n{} = {}\n", entry.help, entry.unit.empty() ? "" : fmt::format(", {}", entry.unit),
                      entry.allowed.empty() ? "" : "; " + entry.allowed, entry.name, entry.toml());
    }
    return text;
  }
  [[nodiscard]] const std::string& program() const { return program_; }
  /// Throws FileError.
  void write_toml(const std::filesystem::path& path) const { write_file(path, toml()); }

 private:
  enum class Kind { number, text, truth };
  struct Help : CLI::Formatter {  // without CLI11's remark that an option may be repeated
    std::string make_option_opts(const CLI::Option* option) const override {
      return option->get_items_expected_max() == 0 ? "" : " " + option->get_type_name();
    }
  };
  struct Entry {
    std::string name{}, help{}, allowed{}, unit{}, type{}, shown{};
    Kind kind = Kind::number;
    std::function<void(std::string_view text, std::string_view where)> read{};
    std::function<std::string()> toml{};
  };

  void insert(Entry entry) {
    for (const Entry& other : entries_)
      if (other.name == entry.name) throw ParameterError("The option --" + entry.name + " is declared twice.");
    entries_.push_back(std::move(entry));
  }

  static std::string checked_text(std::string_view text, std::string_view where) {
    if (trimmed(text).empty())
      throw ParameterError(fmt::format("{}: the value is empty; a text is needed.", where));
    if (text.find('\0') != std::string_view::npos)
      throw ParameterError(fmt::format("{}: {} contains a zero byte.", where, in_quotes(text)));
    return std::string(text);
  }

  static void single(const std::string& name, const std::vector<std::string>& texts) {
    if (texts.size() > 1)
      throw ParameterError(
          fmt::format("{} is given twice: {} and {}.", name, in_quotes(texts[0]), in_quotes(texts[1])));
  }

  [[nodiscard]] std::vector<std::string> names(std::string_view prefix) const {
    std::vector<std::string> result;
    for (const Entry& entry : entries_) {
      result.push_back(fmt::format("{}{}", prefix, entry.name));
      if (entry.kind == Kind::truth && !prefix.empty()) result.push_back("--no-" + entry.name);
    }
    if (!prefix.empty()) {
      for (const Source& source : sources_) result.push_back("--" + source.name);
      result.insert(result.end(), {"--config", "--help", "--info"});
    }
    return result;
  }

  [[noreturn]] void refuse(const std::string& argument) const {
    const std::string option = argument.substr(0, argument.find('='));
    if (!option.starts_with('-') || option == "--")
      throw ParameterError(
          fmt::format("unexpected argument {}; every option has the form --name value.", in_quotes(argument)));
    const std::string near = nearest_name(option, names("--"));
    throw ParameterError(fmt::format("unknown option {}; {}", option,
                                     near.empty() ? "--help lists all." : "did you mean " + near + "?"));
  }

  /// Takes over the values of a file.
  void apply(const std::vector<ConfigEntry>& values, const std::string& file) {
    for (const ConfigEntry& config : values) {
      const auto entry =
          std::find_if(entries_.begin(), entries_.end(), [&](const Entry& e) { return e.name == config.key; });
      if (entry == entries_.end()) {
        const std::string near = nearest_name(config.key, names(""));
        throw ParameterError(fmt::format("{}: unknown key {}; {}", file, in_quotes(config.key),
                                         near.empty() ? "--help lists all options." : "did you mean " + near + "?"));
      }
      const std::string where = file + ": " + entry->name;
      if ((entry->kind == Kind::truth) != (config.kind == ConfigEntry::Kind::truth))
        throw ParameterError(fmt::format("{}: {} is not allowed: it must be {}.", where, config.value,
                                         entry->kind == Kind::truth  ? "true or false"
                                         : entry->kind == Kind::text ? "a text"
                                                                     : "a number"));
      if (entry->kind == Kind::text && config.kind == ConfigEntry::Kind::number)
        throw ParameterError(fmt::format("{}: {} is a number, but a text in quotes is needed.", where, config.value));
      entry->read(config.value, where);
    }
  }

  struct Source {
    std::string name, type, help;
    std::function<std::string(const std::string& file)> read;
  };

  std::string program_, purpose_;
  std::vector<Entry> entries_;
  std::vector<Source> sources_;
};

}  // namespace tactoid
