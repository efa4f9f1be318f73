# docs/gallery.md from clouds.txt and the figures that make.sh measured.
BEGIN {
    FS = "\t"
    while ((getline line < figures) > 0) {
        split(line, f, "\t")
        primitives[f[1]] = f[2]; bytes[f[1]] = f[3]; making[f[1]] = f[4]; rendering[f[1]] = f[5]
    }
    print "# Gallery"
    print ""
    print "Every cloud here is a command you can type, and most are smaller than the picture of them. Look at one from all"
    print "sides with `neph-view -` in place of the last command; change a number, or the `--seed`, and it is yours."
    print ""
    print "The pictures are path-traced by `neph-render` (its reference method, some dozen paths a pixel, `--denoise`), made by"
    print "`sh examples/gallery/make.sh build/release/bin docs/gallery` from [clouds.txt](../examples/gallery/clouds.txt), as is"
    print "this page. [Figures](#figures) stand at its end."
}
/^\/\// { next }
/^# / { print ""; print "## " substr($0, 3); print ""; next }
/^## / {
    split(substr($0, 4), part, " [|] ")
    name = part[1]; title[name] = part[2]; order[++count] = name
    print ""; print "### " part[2]; print ""; print "![" part[2] "](gallery/" name ".png)"; print ""
    next
}
/^[$] / { make = substr($0, 3); next }
/^> / {
    gsub(/ [|] /, " | \\\n        ", make)
    print ""
    print "    " make " | \\"
    print "        neph-render - --size 480x300 --denoise " substr($0, 3) " \\"
    print "        -o " name ".png"
    next
}
/./ { print }
END {
    print ""
    print "## Figures"
    print ""
    print "Processor seconds to make the cloud and to render its picture of 480x300 pixels: an Intel Xeon with two cores, gcc 12.2."
    print ""
    print "| cloud | primitives | bytes | made, s | rendered, s |"
    print "|---|---:|---:|---:|---:|"
    for (i = 1; i <= count; i++) {
        n = order[i]
        print "| " title[n] " | " primitives[n] " | " bytes[n] " | " (making[n] < 0.01 ? "below 0.01" : making[n]) " | " rendering[n] " |"
    }
}
