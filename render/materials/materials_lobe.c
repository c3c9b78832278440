/* render/materials/materials_lobe.c: how much a glossy surface reflects by angle, and how its lobe spreads. */
#include "render/materials/materials.h"

/* Square of the refractive index with this reflectance at normal incidence, (n - 1)^2 / (n + 1)^2. */
static double index_squared(double rho_normal)
{
    const double root = sqrt(rho_normal), index = (1 + root) / (1 - root);
    return index * index;
}

/* Unpolarised reflectance of a dielectric (Fresnel), the squares of its two polarisations over one denominator. */
static double fresnel_dielectric(double index2, double cosine)
{
    const double inside = sqrt(index2 - 1 + cosine * cosine); /* times the index: its cosine */
    const double a = cosine - inside, b = cosine + inside, c = index2 * cosine - inside, d = index2 * cosine + inside;
    const double ad = a * d, bc = b * c, bd = b * d;
    return 0.5 * (ad * ad + bc * bc) / (bd * bd);
}

/* Schlick (Computer Graphics Forum 13, 1994): for metals, where the dip before grazing is slight. */
static double fresnel_schlick(double rho_normal, double cosine)
{
    const double away = 1 - cosine, away2 = away * away;
    return rho_normal + (1 - rho_normal) * away2 * away2 * away;
}

/* What reflects less than water (0.02) at normal incidence is only partly covered by gloss, and rises by that part;
 * what reflects more than 0.3 is a metal, and between 0.2 and 0.3 the kind is unknown. The effect is less for a
 * rough surface: its facets are seldom at grazing angles when it is (the square is a guess, that keeps grass dull). */
double material_fresnel(double gloss_rho, double roughness_rad, double cosine)
{
    if (!(gloss_rho > 0)) return 0;
    if (gloss_rho >= 1) return 1;
    const double        cover = fmin(gloss_rho / 0.02, 1), normal = fmax(gloss_rho, 0.02), c = clamp(cosine, 0, 1);
    const double        metal = clamp((normal - 0.2) / 0.1, 0, 1);
    static const double water_index2 = 1.7673876858061457; /* of 0.02, below which most ground is */
    double              reflected = 0;
    if (metal < 1)
        reflected += (1 - metal) * fresnel_dielectric(gloss_rho > 0.02 ? index_squared(normal) : water_index2, c);
    if (metal > 0) reflected += metal * fresnel_schlick(normal, c);
    const double smooth = 1 - fmin(roughness_rad, 1);
    return gloss_rho + cover * smooth * smooth * (reflected - normal);
}

double material_pane(double rho, double roughness_rad, double cosine)
{
    if (!(rho > 0)) return 0;
    const double c = clamp(cosine, 0, 1), index2 = index_squared(rho / (2 - rho)), inside = sqrt(index2 - 1 + c * c);
    const double across = (c - inside) / (c + inside), along = (index2 * c - inside) / (index2 * c + inside);
    const double s = across * across, p = along * along, smooth = 1 - fmin(roughness_rad, 1);
    return rho + smooth * smooth * (s / (1 + s) + p / (1 + p) - rho);
}

void material_split(double *diffuse, double *lobe, double rho, double gloss, double roughness_rad, double cosine)
{
    const double gloss_rho = rho * gloss;
    *lobe = material_fresnel(gloss_rho, roughness_rad, cosine);
    /* the increase of the lobe at grazing angles is taken from the diffuse share */
    *diffuse = gloss_rho < 1 ? (rho - gloss_rho) * (1 - *lobe) / (1 - gloss_rho) : 0;
}

/* Smith's masking for Beckmann slopes, as the rational fit of Walter, Marschner, Li, Torrance (EGSR 2007). */
static double smith_shadow(double slope, double cosine)
{
    const double sine2 = 1 - cosine * cosine;
    if (!(sine2 > 1e-12)) return 1;
    const double a = cosine / (slope * sqrt(sine2));
    return a >= 1.6 ? 1 : a * (3.535 + 2.181 * a) / (1 + a * (2.276 + 2.577 * a));
}

double material_slope2(double roughness_rad)
{
    /* the sun's disc, 4.65 mrad in radius, blurs the lobe as slopes of half that would; it also keeps a perfect
     * mirror finite */
    return roughness_rad * roughness_rad + 0.0023 * 0.0023;
}

double material_lobe(double roughness_rad, const double n[3], const double towards_eye[3], const double towards_sun[3])
{
    const double n_eye = v3_dot(n, towards_eye), n_sun = v3_dot(n, towards_sun);
    if (!(n_eye > 0 && n_sun > 0)) return 0;
    double half[3];
    v3_add(half, towards_eye, towards_sun);
    if (!v3_normalize(half, half)) return 0;
    const double n_half = v3_dot(n, half), n_half2 = n_half * n_half;
    if (!(n_half > 1e-3)) return 0;
    const double slope2 = material_slope2(roughness_rad);
    const double tangent2 = (1 - n_half2) / n_half2;
    if (tangent2 > 40 * slope2) return 0; /* e^-40 */
    const double slopes = exp(-tangent2 / slope2) / (pi_rad * slope2 * n_half2 * n_half2), slope = sqrt(slope2);
    return slopes * smith_shadow(slope, n_eye) * smith_shadow(slope, n_sun) / (4 * n_eye);
}
