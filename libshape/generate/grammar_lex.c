/* A grammar's text as characters with their places: UTF-8, comments, lines that go on, words, numbers, mistakes.
 * The language is docs/grammar.md. */
#include "generate/grammar_private.h"

#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

enum { INVALID = 0xfffd };

void grammar_mistake(parser *p, place at, const char *format, ...)
{
    shape_mistakes *all = p->mistakes;
    if (all->count == SHAPE_GRAMMAR_MISTAKES_MAX) {
        all->more = true;
        return;
    }
    /* Kept in the text's order: some checks come after the whole text is read. */
    int i = all->count++;
    while (i > 0 && (all->items[i - 1].line > at.line ||
                     (all->items[i - 1].line == at.line && all->items[i - 1].column > at.column))) {
        all->items[i] = all->items[i - 1];
        i--;
    }
    all->items[i].line = at.line;
    all->items[i].column = at.column;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(all->items[i].text, sizeof all->items[i].text, format, arguments);
    va_end(arguments);
}

/* One character and its size in bytes; INVALID and 1 for bytes that are not UTF-8 (RFC 3629). */
static uint32_t decode(const unsigned char *text, size_t size, size_t *length)
{
    *length = 1;
    unsigned lead = text[0];
    if (lead < 0x80)
        return lead;
    size_t wanted = lead >= 0xf0 ? 4 : lead >= 0xe0 ? 3 : 2;
    if (lead < 0xc2 || lead > 0xf4 || size < wanted)
        return INVALID;
    uint32_t c = lead & (0x7fu >> wanted);
    for (size_t i = 1; i < wanted; i++) {
        if ((text[i] & 0xc0) != 0x80)
            return INVALID;
        c = c << 6 | (text[i] & 0x3fu);
    }
    static const uint32_t least[] = {0, 0, 0x80, 0x800, 0x10000};
    if (c < least[wanted] || c > 0x10ffff || (c >= 0xd800 && c <= 0xdfff))
        return INVALID;
    *length = wanted;
    return c;
}

static void add_cell(parser *p, uint32_t c, place at)
{
    if (p->out_of_memory || shape_array_reserve((void **)&p->cells, &p->cell_capacity, p->cell_count + 1,
                                                sizeof *p->cells, NULL)) {
        p->out_of_memory = true;
        return;
    }
    cell one = {c, at};
    p->cells[p->cell_count++] = one;
}

static bool is_blank(uint32_t c)
{
    return c == ' ' || c == '\t' || c == '\r';
}

/* Whether nothing but blanks stands between a place in the text and the end of its line. */
static bool line_ends(const unsigned char *text, size_t size, size_t i)
{
    while (i < size && is_blank(text[i]))
        i++;
    return i == size || text[i] == '\n';
}

void grammar_lex(parser *p, const unsigned char *text, size_t size)
{
    place at = {1, 1};
    bool comment = false, goes_on = false;
    size_t start =
        size >= 3 && !memcmp(text, "\xef\xbb\xbf", 3) ? 3 : 0; /* a byte order mark is no character */
    for (size_t i = start, length; i < size; i += length) {
        uint32_t c = decode(text + i, size - i, &length);
        if (c == INVALID && length == 1)
            grammar_mistake(p, at, "a byte that is not UTF-8 (save the file as UTF-8)");
        else if ((c < ' ' && c != '\n' && !is_blank(c)) || c == 0x7f)
            grammar_mistake(p, at, "a control character, U+%04X (remove it)", (unsigned)c);
        if (c == '\n') {
            add_cell(p, goes_on ? ' ' : '\n', at);
            comment = goes_on = false;
            at.line++;
            at.column = 1;
            continue;
        }
        if (c == '#')
            comment = true;
        if (c == '\\' && !comment && line_ends(text, size, i + 1))
            goes_on = true;
        else if (!comment && !goes_on && c >= ' ' && c != 0x7f && !(c == INVALID && length == 1))
            add_cell(p, c, at);
        else if (!comment && is_blank(c))
            add_cell(p, ' ', at);
        at.column++;
    }
    add_cell(p, 0, at);
}

uint32_t grammar_peek(const parser *p, size_t ahead)
{
    return p->next + ahead < p->end ? p->cells[p->next + ahead].c : 0;
}

place grammar_here(const parser *p)
{
    return p->cells[p->next].at;
}

void grammar_skip_blanks(parser *p)
{
    while (p->next < p->end && is_blank(p->cells[p->next].c))
        p->next++;
}

bool grammar_at_end(parser *p)
{
    grammar_skip_blanks(p);
    return p->next >= p->end;
}

bool grammar_is_letter(uint32_t c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

bool grammar_is_digit(uint32_t c)
{
    return c >= '0' && c <= '9';
}

const char *grammar_show(uint32_t c, char text[48])
{
    if (c == 0 || c == '\n')
        snprintf(text, 48, "the end of the line");
    else if (c == 0xa0 || c == 0x202f || c == 0x2009)
        snprintf(text, 48, "a space that is not a plain one");
    else if (c < 0x80)
        snprintf(text, 48, "'%c'", (char)c);
    else if (c < 0x800)
        snprintf(text, 48, "'%c%c'", (char)(0xc0 | c >> 6), (char)(0x80 | (c & 0x3f)));
    else if (c < 0x10000)
        snprintf(text, 48, "'%c%c%c'", (char)(0xe0 | c >> 12), (char)(0x80 | (c >> 6 & 0x3f)),
                 (char)(0x80 | (c & 0x3f)));
    else
        snprintf(text, 48, "'%c%c%c%c'", (char)(0xf0 | c >> 18), (char)(0x80 | (c >> 12 & 0x3f)),
                 (char)(0x80 | (c >> 6 & 0x3f)), (char)(0x80 | (c & 0x3f)));
    return text;
}

/* The digits at the cursor, appended to a text while there is room; how many there were. */
static int take_digits(parser *p, char *text, size_t room, size_t *used)
{
    int count = 0;
    for (; grammar_is_digit(grammar_peek(p, 0)); p->next++, count++)
        if (*used + 1 < room)
            text[(*used)++] = (char)p->cells[p->next].c;
    return count;
}

/* The exponent behind a number's digits; clamped, since a double ends long before. */
static int take_exponent(parser *p)
{
    uint32_t e = grammar_peek(p, 0), sign = grammar_peek(p, 1);
    size_t skip = sign == '-' || sign == '+' ? 2 : 1;
    if ((e != 'e' && e != 'E') || !grammar_is_digit(grammar_peek(p, skip)))
        return 0;
    int exponent = 0;
    for (p->next += skip; grammar_is_digit(grammar_peek(p, 0)); p->next++)
        exponent = exponent < 10000 ? exponent * 10 + (int)(p->cells[p->next].c - '0') : exponent;
    return sign == '-' ? -exponent : exponent;
}

bool grammar_number(parser *p, double *value)
{
    enum { DIGITS = 400 };
    char text[DIGITS + 32];
    place at = grammar_here(p);
    size_t start = p->next, used = 0;
    int whole = take_digits(p, text, DIGITS, &used), fraction = 0;
    if (grammar_peek(p, 0) == '.' && grammar_peek(p, 1) != '.' &&
        (whole || grammar_is_digit(grammar_peek(p, 1)))) {
        p->next++;
        fraction = take_digits(p, text, DIGITS, &used);
    }
    if (!whole && !fraction) {
        p->next = start;
        return false;
    }
    int exponent = take_exponent(p);
    if (whole + fraction >= DIGITS) {
        grammar_mistake(p, at, "a number of %d digits (write fewer than %d)", whole + fraction, DIGITS);
        *value = 0;
        return true;
    }
    /* Without a point in it strtod reads the same in every locale, and rounds correctly. */
    snprintf(text + used, sizeof text - used, "e%d", exponent - fraction);
    *value = strtod(text, NULL);
    if (!isfinite(*value)) {
        grammar_mistake(p, at, "the number is too large (write one below 1e308)");
        *value = 0;
    }
    return true;
}

bool grammar_word(parser *p, bool hyphens, char word[NAME_ROOM])
{
    size_t used = 0;
    if (!grammar_is_letter(grammar_peek(p, 0)) && grammar_peek(p, 0) != '_')
        return false;
    for (;; p->next++) {
        uint32_t c = grammar_peek(p, 0);
        bool hyphen = hyphens && c == '-' && grammar_is_letter(grammar_peek(p, 1));
        if (!grammar_is_letter(c) && !grammar_is_digit(c) && c != '_' && !hyphen)
            break;
        if (used + 1 < NAME_ROOM)
            word[used++] = (char)c;
    }
    word[used] = 0;
    return true;
}

/* Levenshtein's distance of two words shorter than NAME_ROOM. */
static int distance(const char *a, const char *b)
{
    int row[NAME_ROOM];
    int length = (int)strlen(b);
    for (int j = 0; j <= length; j++)
        row[j] = j;
    for (int i = 1; a[i - 1]; i++) {
        int diagonal = row[0];
        row[0] = i;
        for (int j = 1; j <= length; j++) {
            int least = diagonal + (a[i - 1] != b[j - 1]);
            diagonal = row[j];
            if (row[j] + 1 < least)
                least = row[j] + 1;
            if (row[j - 1] + 1 < least)
                least = row[j - 1] + 1;
            row[j] = least;
        }
    }
    return row[length];
}

const char *grammar_nearest(const char *word, const char *const *names)
{
    const char *best = NULL;
    int least = strlen(word) > 3 ? 3 : 2; /* a short word within two changes of everything is no hint */
    for (; *names; names++) {
        int d = distance(word, *names);
        if (d < least) {
            least = d;
            best = *names;
        }
    }
    return best;
}
