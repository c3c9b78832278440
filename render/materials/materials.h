/* render/materials/materials.h: optics of every material, from etc/materials.csv (with a source for each row).
 *
 * Reflectances are hemispherical band averages; emissivity = 1 - reflectance (Kirchhoff, opaque). */
#ifndef RENDER_MATERIALS_MATERIALS_H
#define RENDER_MATERIALS_MATERIALS_H

#include "pitviper_channels.h"
#include "entities/catalog/catalog.h"
#include "terrain/surface.h"
#include "terrain/woods/plant.h"

/* Reflective channels by place (pitviper_channels.h). */
enum {
    optical_channel_b = SPECTRAL_B,
    optical_channel_g = SPECTRAL_G,
    optical_channel_r = SPECTRAL_R,
    optical_channel_pan = SPECTRAL_PAN,
    optical_channel_nir = SPECTRAL_NIR,
    optical_channel_count
};

typedef struct Material {
    char  name[32];
    float rho[optical_channel_count];
    float rho_mwir, rho_lwir;
    float tau[optical_channel_count]; /* transmittance, hemispherical: of leaves (etc/plant_optics.csv), else 0 */
    float tau_mwir, tau_lwir;
    float solar_absorptance;
    float gloss;       /* share of the reflectance that is a lobe, 0 .. 1; 1: bare metal, glass */
    float roughness;   /* width of that lobe, rad rms slope */
    float metal;       /* 1: mirrors radar; 0: does not */
    float radar_gamma; /* diffuse backscatter, sigma0 = gamma sin(grazing), relative */
    float conductivity_w_mk, density_kg_m3, heat_capacity_j_kgk; /* of the layer below the surface */
} Material;

/* Rows stand in the order: none, the program's, those of plants, the user's own with new names. The user's own row of
 * a name that the program has stands at that row's place. */
typedef struct Materials {
    int       count;
    Material *material;  /* [0] is "none", black */
    int       more;      /* rows behind count that no class or part has: canopies (render/light/far_woods.h) */
    int       own_first; /* the first with a new name of the user's; count: there is none */
    int       surface[SURFACE_COUNT];           /* material of each surface class */
    int       plant[PLANT_KINDS][PLANT_ORGANS]; /* rows of etc/plant_optics.csv; 0: the kind has no such organ */
    int       mark[PLANT_MARKS];                /* rows of what trunks are painted with; 0: unmarked */
    int     **part;                             /* [model][part] */
    int     **damaged;                          /* [model][part * model_damage_states + damage]; NULL: as undamaged. The
                                                 * model's own entry, else `burnt` for destroyed, where there is such a row */
    int   model_count;
    int  *parts;                             /* [model] parts of it */
    float ground_rho[optical_channel_count]; /* mean of the land classes: what lights things from below */
} Materials;

/* surfaces_path: CSV surface, material. Every material a model or surface names must exist: otherwise a
 * logged error and STATUS_BAD_VALUE. catalog may be NULL (no models). */
Status materials_open(Materials *out, const char *path, const char *surfaces_path, const Catalog *catalog);
/* Adds the rows of plants (etc/plant_optics.csv) before the user's new ones, and fills in plant[][] and mark[];
 * ground_path (etc/woods.csv): the material of the ground beneath them replaces that of its class. Once; failures are
 * logged. */
Status materials_add_plants(Materials *m, const char *path, const char *ground_path);
void   materials_close(Materials *materials);
int    materials_find(const Materials *materials, const char *name); /* -1: none */

/* Rows of a model's parts: part[part_count], and damaged[part_count][model_damage_states] as Materials.damaged. path:
 * of the table, for the log. STATUS_BAD_VALUE: a part's material is not in it. */
Status materials_of_model(int *part, int *damaged, const Materials *m, const Model *model, const char *path);

/* Row of a part of a model in a state of damage (snapshot_damage). */
static inline int material_of_part(const Materials *m, int model, int part, int damage)
{
    if (damage > 0 && m->damaged) return m->damaged[model][part * model_damage_states + damage];
    return m->part[model][part];
}

/* Transmittance over reflectance in a band (AirBand): what the light on a leaf's far side counts of that on its near
 * one; 0: opaque. */
static inline double material_through(const Material *m, int band)
{
    const float tau = band == SPECTRAL_MWIR ? m->tau_mwir : band == SPECTRAL_LWIR ? m->tau_lwir : m->tau[band];
    const float rho = band == SPECTRAL_MWIR ? m->rho_mwir : band == SPECTRAL_LWIR ? m->rho_lwir : m->rho[band];
    return rho > 0 ? (double)tau / (double)rho : 0;
}

/* A pane of glass, whose inside returns nothing: gloss 1, and too dark for a metal. In sunlight it mirrors with both
 * its sides; thermal bands do not get to the second. */
static inline bool material_is_pane(const Material *m) { return m->gloss >= 1 && m->rho[optical_channel_pan] < 0.2f; }

static inline bool material_is_leaf(const Material *m) { return m->tau[optical_channel_nir] > 0; }

/* Whether some material lets light through. */
bool materials_let_through(const Materials *m);

/* The lobe of a glossy surface. material_fresnel: share reflected by it at an angle of this cosine, from gloss_rho
 * (reflectance times gloss) at normal incidence to 1 at grazing where it is smooth; 0 for gloss_rho = 0. Smooth, and
 * 0.02 .. 0.2 at normal incidence: Fresnel's own for the refractive index that has it (0.04: glass of 1.5).
 * material_split: that, and what is left of the diffuse share so that their sum never passes 1.
 * material_lobe: radiance over irradiance facing the sun, 1/sr, for a reflectance of 1: Beckmann's slopes of
 * rms roughness_rad with Smith's masking; its whole over all directions is at most the cosine n_sun.
 * All vectors are unit; n and towards_eye must be on the same side. 0 when the sun is behind.
 * material_slope2: square of the slopes of that lobe, the sun's disc in it. */
double material_fresnel(double gloss_rho, double roughness_rad, double cosine);
/* Of a pane that mirrors this much at normal incidence with both its sides, back and forth between them, incoherently
 * and without loss: 2 r / (1 + r) of each polarisation's r of one side. Within 1e-12 of that; reflectance below 0.4. */
double material_pane(double rho, double roughness_rad, double cosine);
void   material_split(double *diffuse, double *lobe, double rho, double gloss, double roughness_rad, double cosine);
double material_slope2(double roughness_rad);
double material_lobe(double roughness_rad, const double n[3], const double towards_eye[3], const double towards_sun[3]);

#endif
