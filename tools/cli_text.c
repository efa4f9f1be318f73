/* Texts for names and provenance lines: UTF-8 without control characters (docs/neph-format.md). */
#include <stddef.h>
#include <stdint.h>

#include "cli_private.h"

/* The length of the good character at text, or 0. A zero byte ends every sequence, so nothing behind it is read. */
static size_t good_character(const unsigned char *text)
{
    static const uint32_t smallest[5] = {0, 0, 0x80, 0x800, 0x10000};
    unsigned char first = text[0];
    size_t length = first < 0x80 ? 1 : first >> 5 == 6 ? 2 : first >> 4 == 14 ? 3 : first >> 3 == 30 ? 4 : 0;
    uint32_t code = length == 1 ? first : first & (0x7fu >> length);
    for (size_t i = 1; i < length; i++) {
        if (text[i] >> 6 != 2)
            return 0;
        code = code << 6 | (text[i] & 0x3fu);
    }
    if (code < 0x20 || (code >= 0x7f && code < 0xa0) || (code >= 0xd800 && code <= 0xdfff) || code > 0x10ffff)
        return 0;
    return code < smallest[length] ? 0 : length;
}

void cli_clean_text(char *text)
{
    while (*text) {
        size_t length = good_character((const unsigned char *)text);
        if (!length)
            *text = '?';
        text += length ? length : 1;
    }
}
