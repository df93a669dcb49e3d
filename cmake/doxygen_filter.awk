# What Doxygen reads instead of a file: awk -f doxygen_filter.awk FILE. Lines keep their numbers.
#
# Headers: an indented line of a /// comment (three blanks or more, outside of a list) is a formula or code, and is shown as it
# stands. Pages: links to sources become plain text, because Doxygen gives sources other names; links to sections go to the page, and
# within it become plain text.
FILENAME ~ /\.md$/ {
  while (match($0, /\[[^]]*\]\([^):]*(\.cpp|\.hpp|\.py|\.geo|\.cff|\.sh|LICENSE)\)/)) {
    text = substr($0, RSTART + 1, index(substr($0, RSTART), "](") - 2)
    gsub(/`/, "", text)
    $0 = substr($0, 1, RSTART - 1) "`" text "`" substr($0, RSTART + RLENGTH)
  }
  while (match($0, /\[[^]]*\]\(#[^)]*\)/)) {
    text = substr($0, RSTART + 1, index(substr($0, RSTART), "](") - 2)
    $0 = substr($0, 1, RSTART - 1) text substr($0, RSTART + RLENGTH)
  }
  gsub(/\.md#[a-z-]*\)/, ".md)")
  print
  next
}
{
  comment = match($0, /^ *\/\/\/( |$)/)
  text = comment ? substr($0, RSTART + RLENGTH) : ""
  if (text ~ /^ *- /) list = 1
  else if (text ~ /^[^ ]/ || text == "") list = 0
  verbatim = comment && !list && text ~ /^  +[^ ]/ && (inside || before_is_comment)
  if (verbatim && !inside) before = before " @code{.unparsed}"
  if (!verbatim && inside) before = before " @endcode"
  if (NR > 1) print before
  before = $0
  before_is_comment = comment
  inside = verbatim
}
END {
  if (FILENAME !~ /\.md$/) print before (inside ? " @endcode" : "")
}
