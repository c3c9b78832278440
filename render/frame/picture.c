/* render/frame/picture.c: the radiance planes of a picture, and the channel of light that each shows. */
#include "render/frame/picture.h"

int picture_channels(PictureChannel out[picture_radar], unsigned bands, OpticalChannels optical)
{
    static const AirBand rgb[3] = {AIR_R, AIR_G, AIR_B};
    int                  count = 0;
    if (has_band(bands, BAND_OPTICAL)) {
        if (optical == OPTICAL_RGB) {
            for (int c = 0; c < 3; c++) out[count++] = (PictureChannel){picture_optical + c, BAND_OPTICAL, rgb[c]};
        } else {
            const AirBand one = optical == OPTICAL_NIR    ? AIR_NIR
                                : optical == OPTICAL_RED  ? AIR_R
                                : optical == OPTICAL_BLUE ? AIR_B
                                                          : AIR_PAN;
            out[count++] = (PictureChannel){picture_optical, BAND_OPTICAL, one};
        }
    }
    if (has_band(bands, BAND_MWIR)) out[count++] = (PictureChannel){picture_mwir, BAND_MWIR, AIR_MWIR};
    if (has_band(bands, BAND_LWIR)) out[count++] = (PictureChannel){picture_lwir, BAND_LWIR, AIR_LWIR};
    return count;
}

int picture_smoke_channel(Band band, unsigned bands, OpticalChannels optical)
{
    PictureChannel of[picture_radar];
    const int      count = picture_channels(of, bands, optical);
    for (int k = 0; k < count; k++)
        if (of[k].band == band) /* of three colours, green */
            return k + 1 < count && of[k + 1].band == band ? (int)of[k + 1].channel : (int)of[k].channel;
    return -1;
}

unsigned render_air_bands(unsigned bands, OpticalChannels optical)
{
    PictureChannel of[picture_radar];
    unsigned       air = 0;
    for (int k = picture_channels(of, bands, optical) - 1; k >= 0; k--) air |= 1u << of[k].channel;
    return air;
}

Band picture_band(int plane)
{
    return plane == picture_mwir    ? BAND_MWIR
           : plane == picture_lwir  ? BAND_LWIR
           : plane == picture_radar ? BAND_RADAR
                                    : BAND_OPTICAL;
}

float *picture_plane(const Picture *picture, int plane)
{
    return plane == picture_mwir    ? picture->mwir
           : plane == picture_lwir  ? picture->lwir
           : plane == picture_radar ? picture->radar
                                    : picture->optical[plane - picture_optical];
}

double picture_contrast(const Picture *p, const float *value, int x, int y)
{
    const size_t at = (size_t)y * (size_t)p->width + (size_t)x, row = (size_t)p->width;
    const double here = (double)value[at];
    double       sum = 0;
    int          count = 0;
    if (x > 0) sum += (value[at - 1] - here) * (value[at - 1] - here), count++;
    if (x + 1 < p->width) sum += (value[at + 1] - here) * (value[at + 1] - here), count++;
    if (y > 0) sum += (value[at - row] - here) * (value[at - row] - here), count++;
    if (y + 1 < p->height) sum += (value[at + row] - here) * (value[at + row] - here), count++;
    return count > 0 ? sum / count : 0;
}

void render_counters_add(RenderCounters *sum, const RenderCounters *more)
{
    VisibilityCounters       *to = &sum->visibility;
    const VisibilityCounters *from = &more->visibility;
    sum->rays_primary += more->rays_primary;
    sum->rays_edges += more->rays_edges;
    sum->rays_small_targets += more->rays_small_targets;
    sum->pixels += more->pixels;
    sum->pixels_refined += more->pixels_refined;
    sum->small_targets += more->small_targets;
    sum->small_targets_by_pixels += more->small_targets_by_pixels;
    sum->tiles += more->tiles;
    sum->tiles_without_entities += more->tiles_without_entities;
    to->rays_ground += from->rays_ground;
    to->rays_parts += from->rays_parts;
    to->rays_sun_ground += from->rays_sun_ground;
    to->rays_sun_parts += from->rays_sun_parts;
    to->rays_plants += from->rays_plants;
    to->rays_scenery += from->rays_scenery, to->rays_sun_scenery += from->rays_sun_scenery;
    to->rays_sun_plants += from->rays_sun_plants;
    to->hits_by_table += from->hits_by_table;
    to->rays_sun_for_heat += from->rays_sun_for_heat;
    to->skipped_parts += from->skipped_parts;
    to->skipped_sun_parts += from->skipped_sun_parts;
    for (int k = 0; k < SKIP_COUNT; k++) to->skipped[k] += from->skipped[k];
}
