/* render/air/vapour_private.h: clear air by temperature and water vapour at the ground, of etc/atmosphere/vapour.bin
 * (README.md there has the layout): the six atmospheres of LOWTRAN7 in the order of their temperatures at the ground,
 * each with its vapour times some factors. */
#ifndef RENDER_AIR_VAPOUR_PRIVATE_H
#define RENDER_AIR_VAPOUR_PRIVATE_H

#include "pitviper.h"

enum { vapour_channels_max = 16, vapour_profiles_max = 12, vapour_nodes_max = 128, vapour_levels_max = 64 };
enum { vapour_axis_max = 256, vapour_rows_max = 4096, vapour_temps_max = 12, vapour_cubic = 4 };
enum { vapour_mix_max = 2 * vapour_cubic };

typedef struct VapourChannel {
    char   name[16];
    double low_um, high_um;
    int    weights;                  /* depths of a path: of sunlight, then of emitters */
    bool   self;                     /* depths are drawn over the vapour itself; else over its root */
    double temp_k[vapour_temps_max]; /* of the emitters */
    size_t at;                       /* of its numbers in a node */
} VapourChannel;

typedef struct VapourProfile {
    char         name[32];
    double       temp_k, vapour_kg_m3; /* at the ground */
    int          first, nodes, own;    /* its nodes; the one whose factor is 1 */
    double       humidity;             /* relative, of these */
    const float *level_k;              /* [levels] */
} VapourProfile;

typedef struct Vapour {
    char         *file;
    int           channels, profiles, nodes, levels, heights, ends, pairs, rows, sky[2], sun[2], humidities;
    int           both_ways; /* rows of paths, observer first */
    VapourChannel channel[vapour_channels_max];
    VapourProfile profile[vapour_profiles_max];
    const double *factor;                                                 /* [nodes] */
    const double *level_m, *height_m, *end_m, *sky_m, *sky_deg;           /* axes; sky_m and sky_deg: of sky[2] */
    const double *sun_m, *sun_deg, *humidity;                             /* 0 .. 1 */
    double        sky_slant[vapour_axis_max], sun_slant[vapour_axis_max]; /* of the angles, by slant_x */
    const double *ranges, *range_m;                                       /* [pairs], [rows] */
    const float  *haze;                                                   /* [profile][channel][2][height] */
    const float  *humid;                                                  /* [channel][2][humidity] */
    float        *node;                                                   /* [node][node_floats] */
    size_t        node_floats;
} Vapour;

/* What a node holds: longwave light; the sky of mwir and lwir (k 0, 1) through haze of two visibilities; of paths in
 * haze the ratio of the depth that it adds to its column's, by row; and of the path's radiance, were it opaque, to that
 * of the column's air, by row of both ways. Then of each channel: extinction and scattering of clear air by height,
 * 1/km; depth of clear air to space by height and zenith angle; depths of paths by row and weight. */
enum { vapour_longwave_at = 0 };
static const double        vapour_sky_visibility_m[2] = {23000, 5000};
static inline const float *vapour_node(const Vapour *v, int node) { return v->node + (size_t)node * v->node_floats; }
static inline size_t       vapour_sky_at(const Vapour *v, int which, int k)
{
    return 1 + (size_t)(2 * which + k) * (size_t)v->sky[0] * (size_t)v->sky[1];
}
static inline size_t vapour_hazy_at(const Vapour *v, int k)
{
    return vapour_sky_at(v, 2, 0) + (size_t)k * (size_t)v->rows;
}
static inline size_t vapour_opaque_at(const Vapour *v, int k)
{
    return vapour_hazy_at(v, 2) + (size_t)k * (size_t)v->both_ways;
}
static inline size_t vapour_air_at(const Vapour *v, int channel) { return v->channel[channel].at; }
static inline size_t vapour_scatter_at(const Vapour *v, int channel)
{
    return v->channel[channel].at + (size_t)v->heights;
}
static inline size_t vapour_sun_at(const Vapour *v, int channel)
{
    return v->channel[channel].at + 2 * (size_t)v->heights;
}
static inline size_t vapour_path_at(const Vapour *v, int channel)
{
    return vapour_sun_at(v, channel) + (size_t)v->sun[0] * (size_t)v->sun[1];
}

/* Every octet is checked, by the sums in the file and by what the numbers may be. */
Status vapour_open(Vapour **out, const char *path);
void   vapour_close(Vapour *vapour);
/* -1: it has none of that name. */
int vapour_profile(const Vapour *vapour, const char *name);
/* Of that name, and with these edges. */
int vapour_channel(const Vapour *vapour, const char *name, double low_m, double high_m);

/* Nodes and their shares: of the two profiles about a temperature, straight, those factors of each about the one that
 * gives it the vapour, by a cubic (Lagrange's through four nodes, fewer at the ends). */
typedef struct VapourMix {
    double temp_k;   /* at the ground, of the mix: the nearest that the profiles reach */
    double humidity; /* relative, at the ground */
    int    profiles, profile[2];
    double profile_share[2];
    int    nodes, node[vapour_mix_max];
    double share[2][vapour_mix_max];         /* drawn over the root of the vapour, over the vapour itself */
    int    of[vapour_mix_max];               /* which of the two profiles */
    double swell[2][vapour_channels_max][2]; /* haze of each profile, by humidity: extinction, scattering */
} VapourMix;
/* Continuous in both; vapour beyond the nodes of a profile: the nearest. */
void vapour_mix(VapourMix *out, const Vapour *vapour, double temp_k, double vapour_kg_m3);

/* A number of the nodes at an offset, mixed. */
static inline double vapour_mixed(const Vapour *v, const VapourMix *mix, size_t at, bool self)
{
    double sum = 0;
    for (int k = 0; k < mix->nodes; k++) sum += mix->share[self][k] * (double)vapour_node(v, mix->node[k])[at];
    return sum;
}

/* Extinction (part 0) or scattering (1) of the mix's haze over that of a profile's own, at a height: behind cell of the
 * file's heights by a share of it. */
typedef struct VapourPlace {
    int    cell;
    double share, height_m;
} VapourPlace;
double vapour_haze_scale(const Vapour *vapour, const VapourMix *mix, int own_profile, int channel, int part,
                         const VapourPlace *at);

#endif
