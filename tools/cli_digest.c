/* The inputs in a cloud's provenance line: bare name and SHA-256, as `sha256sum` prints its beginning. */
#include "cli.h"

#include <sys/types.h>

#include <sha2.h>
#include <stdio.h>
#include <string.h>

#include "cli_private.h"

void cli_note_input(const char *path, const void *bytes, size_t size)
{
    enum { NAME_SHOWN = 40, DIGITS = 16 };
    uint8_t digest[SHA256_DIGEST_LENGTH];
    SHA2_CTX context;
    SHA256Init(&context);
    SHA256Update(&context, bytes, size);
    SHA256Final(digest, &context);
    const char *slash = strrchr(path, '/');
    const char *base = slash ? slash + 1 : path;
    int length = (int)strlen(base);
    if (length > NAME_SHOWN) {
        length = NAME_SHOWN;
        while (length && ((unsigned char)base[length] & 0xc0) == 0x80)
            length--;
    }
    char word[128];
    int used = snprintf(word, sizeof word, "%.*s sha256:", length, base);
    for (int i = 0; i < DIGITS / 2; i++)
        used += snprintf(word + used, sizeof word - (size_t)used, "%02x", digest[i]);
    cli_append_input(word);
}
