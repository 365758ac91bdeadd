/* Texts made fit to be printed: see printable.h. UTF-8: RFC 3629. */
#include "io/printable.h"

#include <stdint.h>
#include <string.h>

/* What is a letter to UTF-8, but none to see. */
static bool is_printable(uint32_t letter) {
    if (letter < 0x20) return letter == '\n' || letter == '\t';
    if (letter >= 0x7f && letter < 0xa0) return false;
    bool line_end = letter == 0x2028 || letter == 0x2029;
    bool turns = (letter >= 0x202a && letter <= 0x202e) || (letter >= 0x2066 && letter <= 0x2069);
    return !line_end && !turns;
}

size_t io_printable_letter(const char *text, size_t left, bool *fine) {
    const unsigned char *p = (const unsigned char *)text;
    *fine = false;
    if (left == 0) return 0;
    size_t length = p[0] < 0x80 ? 1 : p[0] >= 0xc2 && p[0] < 0xe0 ? 2 : (p[0] & 0xf0) == 0xe0 ? 3 : 0;
    if (p[0] >= 0xf0 && p[0] < 0xf5) length = 4;
    if (length == 0) return 1; // no letter begins so
    uint32_t letter = length == 1 ? p[0] : p[0] & (0x7fu >> length);
    for (size_t k = 1; k < length; k++) {
        if (k == left) return 0;
        if ((p[k] & 0xc0) != 0x80) return 1;
        letter = letter << 6 | (p[k] & 0x3fu);
    }
    static const uint32_t least[] = {0, 0, 0x80, 0x800, 0x10000};
    bool proper = letter >= least[length] && letter <= 0x10ffff && (letter < 0xd800 || letter > 0xdfff);
    if (!proper) return 1;
    *fine = is_printable(letter);
    return length;
}

void io_printable(char *text, bool lines) {
    size_t left = strlen(text);
    char *to = text;
    while (left > 0) {
        bool fine;
        size_t length = io_printable_letter(text, left, &fine);
        if (length == 0) length = left; // cut off
        if (!lines && (*text == '\n' || *text == '\t')) fine = false;
        if (fine) memmove(to, text, length);
        else *to = '?';
        to += fine ? length : 1;
        text += length;
        left -= length;
    }
    *to = 0;
}
