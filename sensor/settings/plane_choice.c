/* sensor/settings/plane_choice.c: parses a list of names of truth planes. */
#include "sensor/settings/plane_choice.h"

const char *const plane_choice_name[PLANE_CHOICES] = {"range", "entity", "part", "material", "temperature", "normal",
                                                    "instance", "cover", "emissivity"};

bool plane_choice_parse(unsigned *planes, const char *text)
{
    unsigned set = 0;
    *planes      = planes_none;
    if (strcmp(text, "none") == 0) return true;
    if (strcmp(text, "all") == 0) {
        *planes = planes_all;
        return true;
    }
    for (const char *at = text; at;) {
        const size_t length = strcspn(at, ",");
        int          k      = 0;
        while (k < PLANE_CHOICES &&
               (strlen(plane_choice_name[k]) != length || strncmp(plane_choice_name[k], at, length) != 0)) k++;
        if (k == PLANE_CHOICES || set >> k & 1) return false; /* unknown, or named twice */
        set |= 1u << k;
        at = at[length] ? at + length + 1 : NULL;
    }
    *planes = set;
    return true;
}

void plane_choice_why(char *out, size_t out_size, const char *text)
{
    unsigned set = 0;
    char     word[64];
    *out = 0;
    for (const char *at = text; at; at = strchr(at, ',') ? strchr(at, ',') + 1 : NULL) {
        snprintf(word, sizeof word, "%.*s", (int)strcspn(at, ","), at);
        int       k = 0;
        WordMeant meant = word_meant(word);
        while (k < PLANE_CHOICES && strcmp(plane_choice_name[k], word) != 0) word_consider(&meant, plane_choice_name[k++]);
        if (k == PLANE_CHOICES) {
            word_consider_list(&meant, "all|none", '|');
            snprintf(out, out_size, "%s", word_hint(&meant));
            return;
        }
        if (set >> k & 1) snprintf(out, out_size, "; %s is named twice", word);
        set |= 1u << k;
    }
}
