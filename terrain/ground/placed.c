/* terrain/ground/placed.c: ground by seed and place, without an exercise. */
#include "terrain/ground/placed.h"

bool landscape_place_parse(Geodetic *out, const char *text)
{
    static const double low[3] = {-90, -180, -500}, high[3] = {90, 180, 9000};
    double              value[3];
    for (int k = 0; k < 3; k++) {
        char word[40];
        text += strspn(text, " ");
        size_t length = 0;
        while (text[length] && text[length] != ',') length++;
        if (length >= sizeof word || (text[length] == ',') != (k < 2)) return false;
        memcpy(word, text, length);
        word[length] = 0;
        if (!text_to_double(&value[k], word) || !(value[k] >= low[k] && value[k] <= high[k])) return false;
        text += length + (text[length] == ',');
    }
    *out = (Geodetic){value[0] * rad_per_deg, value[1] * rad_per_deg, value[2]};
    return true;
}

Status landscape_place_frame(LocalFrame *out, const Geodetic *place)
{
    return local_frame_at(out, &(Geodetic){place->lat_rad, place->lon_rad, 0});
}

Status landscape_placed(Landscape *out, const LandscapeConfig *config, const Geodetic *place, Cache *cache)
{
    const GroundFix         fix = {.p_enu = {0, 0, place->h_m}};
    const LandscapeEvidence evidence = {.fix_count = 1, .fix = &fix};
    LocalFrame              frame;
    const Status            status = landscape_place_frame(&frame, place);
    return status == STATUS_OK ? landscape_create_kept(out, config, &frame, &evidence, cache) : status;
}
