/* render/scattering/built/facade_echo.c: the field of a piece of a wall or roof, directly and by way of the ground. */
#include "render/scattering/built/facade_echo.h"

#include "render/scattering/field/flat_facet.h"
#include "render/scattering/field/total_field.h"

enum { stream_scattered = 0x3e100000 };

static const double bend_rad = 0.2; /* phase of a piece out of a plane, at most */

double facade_piece_m(double k, double range_m) { return sqrt(4 * bend_rad * range_m / k); }

static void antenna_from(ScatterAntenna *out, const double p_enu[3], const double antenna_enu[3])
{
    v3_sub(out->u, antenna_enu, p_enu);
    out->range_m = v3_length(out->u);
    v3_scale(out->u, 1 / fmax(out->range_m, 1e-9), out->u);
}

/* Integral of exp(-j k path) over a piece, m^2, its middle having path 0; bumps move its corners. */
static double complex integral(const Facade *f, const Piece *piece, const double middle[3], double k,
                               const ScatterAntenna *tx, const ScatterAntenna *rx)
{
    double         x[piece_corners_most], way[3];
    double complex sum = 0;
    for (int i = 0; i < piece->corners; i++) {
        double p[3];
        piece_place(p, &f->plane, piece->corner[i][0], piece->corner[i][1]);
        v3_sub(p, p, middle);
        const double high_m = facade_height(f->row, f->bumps, piece->corner[i][0], piece->corner[i][1]);
        v3_add_scaled(p, p, high_m, f->plane.n);
        x[i] = k * (scatter_path(way, tx, p) + scatter_path(way, rx, p));
    }
    for (int i = 1; i + 1 < piece->corners; i++) {
        const double(*c)[2] = (const double(*)[2])piece->corner;
        const double a[2] = {c[i][0] - c[0][0], c[i][1] - c[0][1]},
                     b[2] = {c[i + 1][0] - c[0][0], c[i + 1][1] - c[0][1]};
        sum += 0.5 * (a[0] * b[1] - a[1] * b[0]) * polygon_mean((const double[3]){x[0], x[i], x[i + 1]});
    }
    return sum;
}

static void scale(ScatterMatrix *s, double complex by) { s->hh *= by, s->hv *= by, s->vh *= by, s->vv *= by; }

/* Share of the amplitude that is mirrored: what S leaves of it; roughness is in the surface. */
static double mirrored_share(const Facade *f, ClutterBand band)
{
    const double s = f->row->scattered[band];
    return sqrt(1 - s * s);
}

/* What is scattered of a piece: amplitudes that its place decides. */
static void add_scattered(ScatterMatrix *out, const Facade *f, const Piece *piece, const FacadeLook *look,
                          double cosine)
{
    const double sigma0 = facade_sigma0(f->row, look->band, &f->surface, look->k, cosine);
    if (!(sigma0 > 0)) return;
    const uint64_t cell = (uint64_t)(uint32_t)piece->i << 32 | (uint32_t)piece->j;
    const double   unit = sqrt(sigma0 * piece->area_m2 / (8 * pi_rad)), cross = unit * sqrt(f->row->hv);
    double         g[6];
    random_normals(g, 6, f->bumps ^ cell * 0x9e3779b97f4a7c15u, stream_scattered, f->number, 0);
    out->hh += unit * CMPLX(g[0], g[1]);
    out->vv += unit * CMPLX(g[2], g[3]);
    out->hv += cross * CMPLX(g[4], g[5]);
    out->vh += cross * CMPLX(g[4], g[5]);
}

void facade_echo(ScatterMatrix *out, const Facade *f, const Piece *piece, const FacadeLook *look, bool mirrored)
{
    double         middle[3];
    ScatterAntenna antenna;
    piece_place(middle, &f->plane, piece->middle[0], piece->middle[1]);
    antenna_from(&antenna, middle, look->p_enu);
    *out = (ScatterMatrix){0};
    const double cosine = v3_dot(antenna.u, f->plane.n);
    if (!(cosine > 0)) return;
    if (mirrored) {
        flat_facet_field(out, &f->surface, look->k, f->plane.n, &antenna, &antenna);
        scale(out, mirrored_share(f, look->band) * integral(f, piece, middle, look->k, &antenna, &antenna));
    }
    add_scattered(out, f, piece, look, cosine);
}

void facade_off_mirror(double off[2], const PiecePlane *plane, const double to_tx[3], const double to_rx[3])
{
    off[0] = 0.5 * (v3_dot(to_tx, plane->s) + v3_dot(to_rx, plane->s));
    off[1] = 0.5 * (v3_dot(to_tx, plane->t) + v3_dot(to_rx, plane->t));
}

bool facade_ground(FacadeGround *out, const Facade *f, const Piece *piece, const FacadeLook *look,
                   const double p_ground[3], const double n_ground[3])
{
    static const double level[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    double              middle[3], p[3];
    piece_place(middle, &f->plane, piece->middle[0], piece->middle[1]);
    ground_plane(&out->plane, p_ground, n_ground, middle, level);
    if (!(out->plane.height_m > 0)) return false;
    antenna_from(&out->direct, middle, look->p_enu);
    out->extra_m = ground_image(&out->image, &out->direct, &out->plane);
    if (!(v3_dot(out->plane.n, out->image.u) < -1e-4) || !(v3_dot(f->plane.n, out->image.u) > 0) ||
        !(v3_dot(f->plane.n, out->direct.u) > 0))
        return false;
    ground_reflection_point(p, &out->image, &out->plane);
    v3_add(out->mirror_enu, middle, p);
    v3_add_scaled(out->foot_enu, middle, -out->plane.height_m, out->plane.n);
    return true;
}

void facade_by_ground(ScatterMatrix *out, const Facade *f, const Piece *piece, const FacadeLook *look,
                      const FacadeGround *ground, const GroundSurface *surface)
{
    double        middle[3];
    GroundLeg     direct, image;
    ScatterMatrix s;
    *out = (ScatterMatrix){0};
    const GroundMirror mirror = {&ground->direct, &ground->image, ground->extra_m, &ground->plane};
    if (!ground_leg_image(&image, &mirror, surface, look->k, look->right)) return;
    if (image.coherence < ground_least_coherence) return;
    ground_leg_direct(&direct, &ground->direct, look->right);
    piece_place(middle, &f->plane, piece->middle[0], piece->middle[1]);
    flat_facet_field(&s, &f->surface, look->k, f->plane.n, &ground->direct, &ground->image);
    scale(&s, image.spread * mirrored_share(f, look->band) *
                  integral(f, piece, middle, look->k, &ground->direct, &ground->image));
    ground_through(&s, &s, &image, &direct);
    *out = (ScatterMatrix){2 * s.hh, s.hv + s.vh, s.vh + s.hv, 2 * s.vv}; /* the other way round: the transpose */
}
