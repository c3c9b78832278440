/* terrain/from_files/culture_texts.c: values of attributes: lengths, numbers, directions, and lists of pairs in one
 * text. */
#include "terrain/from_files/culture_import_private.h"

#include <strings.h>

static const char *skip_blanks(const char *at)
{
    while (*at == ' ' || *at == '\t') at++;
    return at;
}

/* Decimal digits with a point or a comma, and an exponent; NULL: there are none. */
static const char *take_number(double *out, const char *at)
{
    double value = 0, place = 1;
    int    digits = 0, sign = 1;
    if (*at == '+' || *at == '-') sign = *at++ == '-' ? -1 : 1;
    for (; *at >= '0' && *at <= '9'; at++, digits++) value = 10 * value + (*at - '0');
    if ((*at == '.' || *at == ',') && at[1] >= '0' && at[1] <= '9')
        for (at++; *at >= '0' && *at <= '9'; at++, digits++) place /= 10, value += place * (*at - '0');
    else if (*at == '.' && digits > 0) at++;
    if (digits == 0) return NULL;
    if ((*at == 'e' || *at == 'E') && (at[1] == '+' || at[1] == '-' || (at[1] >= '0' && at[1] <= '9'))) {
        const char *power = at + 1;
        int         exponent = 0, minus = *power == '-';
        power += *power == '-' || *power == '+';
        if (*power < '0' || *power > '9') return NULL;
        for (; *power >= '0' && *power <= '9'; power++)
            if (exponent < 400) exponent = 10 * exponent + (*power - '0');
        value *= pow(10, minus ? -exponent : exponent);
        at = power;
    }
    *out = sign * value;
    return isfinite(*out) ? at : NULL;
}

/* Metres of the unit at a place, and what is behind it; 1 where there is none. */
static const char *take_unit(double *metres, const char *at)
{
    static const struct {
        const char *name;
        double      m;
    } units[] = {
        {"metres", 1},      {"meters", 1},    {"metre", 1},   {"meter", 1},   {"feet", 0.3048}, {"foot", 0.3048},
        {"inches", 0.0254}, {"inch", 0.0254}, {"\"", 0.0254}, {"''", 0.0254}, {"'", 0.3048},    {"ft", 0.3048},
        {"in", 0.0254},     {"cm", 0.01},     {"mm", 0.001},  {"km", 1000},   {"m", 1}};
    *metres = 1;
    for (size_t k = 0; k < sizeof units / sizeof *units; k++)
        if (strncasecmp(at, units[k].name, strlen(units[k].name)) == 0) {
            *metres = units[k].m;
            return at + strlen(units[k].name);
        }
    return at;
}

bool culture_metres(double *out_m, const char *text)
{
    double      value, unit, more, more_unit;
    const char *at = skip_blanks(text);
    if (*at == '~') at = skip_blanks(at + 1);
    at = take_number(&value, at);
    if (!at) return false;
    at = skip_blanks(take_unit(&unit, skip_blanks(at)));
    double m = value * unit;
    if (unit == 0.3048 && *at >= '0' && *at <= '9') { /* feet, and inches behind them */
        at = take_number(&more, at);
        if (!at) return false;
        const char *behind = take_unit(&more_unit, skip_blanks(at));
        if (behind != skip_blanks(at) && more_unit != 0.0254) return false;
        m += 0.0254 * more;
        at = skip_blanks(behind);
    }
    if (*at == '.') at = skip_blanks(at + 1);
    if (*at || !isfinite(m)) return false;
    *out_m = m;
    return true;
}

bool culture_number(double *out, const char *text)
{
    double      value;
    const char *at = take_number(&value, skip_blanks(text));
    if (!at) return false;
    at = skip_blanks(at);
    if (*at && *at != ';') return false;
    *out = value;
    return true;
}

bool culture_direction(double *out_rad, const char *text)
{
    static const char *const name[16] = {"N", "NNE", "NE", "ENE", "E", "ESE", "SE", "SSE",
                                         "S", "SSW", "SW", "WSW", "W", "WNW", "NW", "NNW"};
    static const char *const whole[4] = {"north", "east", "south", "west"};
    double                   deg;
    text = skip_blanks(text);
    for (int k = 0; k < 16; k++)
        if (strcasecmp(text, name[k]) == 0 || (k % 4 == 0 && strcasecmp(text, whole[k / 4]) == 0)) {
            *out_rad = k * 22.5 * rad_per_deg;
            return true;
        }
    const char *at = take_number(&deg, text);
    if (!at || !(fabs(deg) <= 360)) return false;
    at = skip_blanks(at);
    if (strncmp(at, "\xc2\xb0", 2) == 0) at += 2;
    if (*at) return false;
    *out_rad = (deg < 0 ? deg + 360 : deg) * rad_per_deg;
    return true;
}

/* A text in quotes, or up to one of these; cut to its size. NULL: the quote is not closed. */
static const char *take_text(char out[culture_text_size], const char *at, const char *ends)
{
    size_t     count = 0;
    const bool quoted = *at == '"';
    for (at += quoted; quoted ? *at != '"' : *at && !strchr(ends, *at); at++) {
        if (!*at) return NULL;
        if (quoted && *at == '\\' && at[1]) at++;
        if (count < culture_text_size - 1) out[count++] = *at;
    }
    while (!quoted && count > 0 && out[count - 1] == ' ') count--;
    out[count] = 0;
    return at + quoted;
}

bool culture_pair(char name[culture_text_size], char value[culture_text_size], const char **at)
{
    const char *next = *at;
    while (*next && strchr(" \t\r\n,{", *next)) next++;
    if (*next != '"') return false;
    next = take_text(name, next, "");
    if (!next) return false;
    next = skip_blanks(next);
    if (next[0] == '=' && next[1] == '>') next += 2;
    else if (*next == ':') next++;
    else return false;
    next = take_text(value, skip_blanks(next), ",}");
    if (!next) return false;
    *at = next;
    return true;
}
