# The code block of a page whose fence is marked "lsys NAME", the COUNTth of that name, the first unless it is said:
#     awk -v name=castle.lsys -v count=2 -f docs/block.awk docs/tutorial.md
BEGIN { if (!count) count = 1 }
/^```/ {
    if (inside) exit
    split($0, word, " ")
    if (word[1] == "```lsys" && word[2] == name && --count == 0) { inside = 1; found = 1; next }
}
inside { print }
END { if (!found) { print "block.awk: no block " name > "/dev/stderr"; exit 1 } }
