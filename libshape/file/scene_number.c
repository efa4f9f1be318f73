/* Numbers in scenes: doubles to text and back without loss, and option texts that may stand as JSON numbers. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "file/scene_private.h"

void scene_number_text(double value, char text[SCENE_NUMBER_MAX])
{
    if (value == 0 && signbit(value)) { /* JSON readers take -0 for an integer, which has no sign */
        snprintf(text, SCENE_NUMBER_MAX, "-0.0");
        return;
    }
    if (fabs(value) < 1e15 && value == floor(value)) {
        snprintf(text, SCENE_NUMBER_MAX, "%.0f", value);
        return;
    }
    for (int digits = 1; digits <= 17; digits++) {
        snprintf(text, SCENE_NUMBER_MAX, "%.*g", digits, value);
        if (strtod(text, NULL) == value)
            return;
    }
}

/* True where the text is what the reader would make again of the bare number: "40" and "0.5" are, "040", "3.80" and
 * "1e3" are not, and stay texts so that a cloud's provenance line comes out the same. */
int scene_number_is_plain(const char *text)
{
    char again[SCENE_NUMBER_MAX];
    size_t length = strlen(text);
    if (!length || length >= SCENE_NUMBER_MAX || text[strspn(text, "0123456789+-.e")])
        return 0;
    if (text[strcspn(text, ".e")])
        scene_number_text(strtod(text, NULL), again);
    else if (length < 19)
        snprintf(again, sizeof again, "%lld", strtoll(text, NULL, 10));
    else
        return 0; /* may be beyond 64 bits with a sign */
    return !strcmp(again, text);
}
