# awk -f docs/api.awk libshape/include/shape/*.h: the C API as one Markdown page, made from the public headers. A header
# becomes a chapter: its first comment as text, then each comment as text over the declarations that it stands above.
# The page is made by the target "docs" and installed with libshape-dev.
function flush_code() {
    sub(/\n+$/, "", code)
    sub(/^\n+/, "", code)
    if (code != "")
        print "```c\n" code "\n```\n"
    code = ""
}
function text_line(line) {
    sub(/^ *\/?\*+\/? ?/, "", line)
    sub(/ *\*\/ *$/, "", line)
    gsub(/</, "\\&lt;", line)
    gsub(/\|/, "\\|", line)
    print line
}
BEGIN { print "# The C API\n\nMade from the headers by docs/api.awk; lengths are metres unless said otherwise.\n" }
FNR == 1 {
    flush_code()
    name = FILENAME
    sub(/.*\/shape\//, "", name)
    print "## shape/" name "\n"
    in_comment = 0
    skip = 0
}
# What only the compiler needs.
/^#ifdef __cplusplus/ { skip = 1 }
skip { if (/^#endif/) skip = 0; next }
/^#(ifndef|define) [A-Z_]+_H$/ || /^#include/ || (/^#endif/ && !conditional) { next }
/^#if/ { conditional++ }
/^#endif/ { conditional-- }
# A comment that begins a line, outside of a declaration's braces, is text.
!in_comment && depth == 0 && /^\/\*/ {
    flush_code()
    in_comment = 1
}
in_comment {
    text_line($0)
    if (/\*\//) {
        in_comment = 0
        print ""
    }
    next
}
{
    code = code $0 "\n"
    bare = $0
    gsub(/\/\*.*\*\//, "", bare)
    depth += gsub(/\{/, "", bare) - gsub(/\}/, "", bare)
}
END { flush_code() }
