/* The scene that a picture holds: a text chunk of a PNG (PNG specification 1.2, 4.2.3) or a string attribute of an EXR
 * (OpenEXR file layout). Pictures are untrusted: every length is held against what is left. */
#include "shape/scene.h"

#include <string.h>

#include "file/scene_private.h"

static const unsigned char png_mark[8] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
static const unsigned char exr_mark[4] = {0x76, 0x2f, 0x31, 0x01};

/* What is left to read. */
typedef struct span {
    const unsigned char *at;
    size_t size;
} span;

static bool begins(span s, const void *mark, size_t size)
{
    return s.size >= size && !memcmp(s.at, mark, size);
}

static void skip(span *s, size_t size)
{
    s->at += size;
    s->size -= size;
}

/* The bytes before the next zero, which is skipped; false where there is none. */
static bool take_word(span *s, span *word)
{
    const unsigned char *end = s->size ? memchr(s->at, 0, s->size) : NULL;
    if (!end)
        return false;
    word->at = s->at;
    word->size = (size_t)(end - s->at);
    skip(s, word->size + 1);
    return true;
}

static bool is_word(span word, const char *text)
{
    return word.size == strlen(text) && !memcmp(word.at, text, word.size);
}

/* The text of a chunk's body, where it is an uncompressed one under our key. */
static bool png_text(span body, bool international, span *text)
{
    span word;
    if (!take_word(&body, &word) || !is_word(word, SHAPE_SCENE_PICTURE_KEY))
        return false;
    if (international) {
        if (body.size < 2 || body.at[0])
            return false;
        skip(&body, 2);
        if (!take_word(&body, &word) || !take_word(&body, &word))
            return false;
    }
    *text = body;
    return true;
}

static bool find_in_png(span s, span *text)
{
    skip(&s, sizeof png_mark);
    while (s.size >= 12) {
        size_t size = (size_t)s.at[0] << 24 | (size_t)s.at[1] << 16 | (size_t)s.at[2] << 8 | s.at[3];
        const unsigned char *kind = s.at + 4;
        if (size > s.size - 12)
            return false;
        bool plain = !memcmp(kind, "tEXt", 4), international = !memcmp(kind, "iTXt", 4);
        if ((plain || international) && png_text((span){s.at + 8, size}, international, text))
            return true;
        skip(&s, size + 12);
    }
    return false;
}

static bool find_in_exr(span s, span *text)
{
    span name, kind;
    if (s.size < 8)
        return false;
    skip(&s, 8); /* mark and version */
    while (take_word(&s, &name) && name.size && take_word(&s, &kind) && s.size >= 4) {
        size_t size = s.at[0] | (size_t)s.at[1] << 8 | (size_t)s.at[2] << 16 | (size_t)s.at[3] << 24;
        skip(&s, 4);
        if (size > s.size)
            return false;
        if (is_word(name, SHAPE_SCENE_PICTURE_KEY) && is_word(kind, "string")) {
            *text = (span){s.at, size};
            return true;
        }
        skip(&s, size);
    }
    return false;
}

bool shape_scene_is_picture(const void *bytes, size_t size)
{
    const span s = {bytes, size};
    return begins(s, png_mark, sizeof png_mark) || begins(s, exr_mark, sizeof exr_mark);
}

bool scene_find_in_picture(const void **bytes, size_t *size)
{
    const span s = {*bytes, *size};
    span text;
    bool found = begins(s, png_mark, sizeof png_mark) ? find_in_png(s, &text) : find_in_exr(s, &text);
    if (!found)
        return false;
    *bytes = text.at;
    *size = text.size;
    return true;
}
