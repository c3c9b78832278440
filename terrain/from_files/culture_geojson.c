/* terrain/from_files/culture_geojson.c: records of culture as GeoJSON (RFC 7946), for GIS programs and for tests. */
#include "terrain/from_files/culture_import.h"
#include "terrain/surface.h"
#include "terrain/woods/plant.h"

typedef struct Drawing {
    const Culture      *culture;
    const CultureFiles *from; /* whose frame, and ground */
} Drawing;

/* Longitude and latitude of a place in ENU on the ground, as culture_place reads it; where there is none, on the plane
 * of the frame. */
static void put_place(FILE *to, const CultureFiles *from, double x_m, double y_m)
{
    const double z_m = from->ground ? from->ground(from->user, x_m, y_m) : 0;
    double       p_ecef[3];
    Geodetic     place = {0};
    ecef_from_enu(p_ecef, from->frame, (const double[3]){x_m, y_m, isfinite(z_m) ? z_m : 0});
    (void)geodetic_from_ecef(&place, p_ecef);
    fprintf(to, "[%.9f, %.9f]", place.lon_rad / rad_per_deg, place.lat_rad / rad_per_deg);
}

static void begin(FILE *to, bool *more, uint64_t id, const char *type)
{
    fprintf(to, "%s{\"type\": \"Feature\", \"id\": \"%016llx\", \"geometry\": {\"type\": \"%s\", \"coordinates\": ",
            *more ? ",\n" : "", (unsigned long long)id, type);
    *more = true;
}

static void put_building(FILE *to, const Drawing *d, const Building *b)
{
    fputs("[[", to);
    for (int k = 0; k <= b->corners; k++) {
        const double *p = d->culture->corner_m[b->first_corner + k % b->corners];
        if (k) fputs(", ", to);
        put_place(to, d->from, p[0], p[1]);
    }
    fprintf(
        to,
        "]]}, \"properties\": {\"record\": \"building\", \"use\": \"%s\", \"base_m\": %.3f, \"eaves_m\": %.3f, "
        "\"ridge_m\": %.3f, \"ridge_rad\": %.4f, \"roof\": \"%s\", \"wall\": \"%s\", \"cover\": \"%s\", \"levels\": "
        "%d, \"heated\": %s, \"chimneys\": %d, \"damage\": %d}}",
        culture_use_name(b->use), (double)b->base_m, (double)b->eaves_m, (double)b->ridge_m, (double)b->ridge_rad,
        culture_roof_name(b->roof), culture_fabric_name(b->wall_fabric), culture_fabric_name(b->roof_fabric), b->levels,
        b->heated ? "true" : "false", b->chimneys, b->damage);
}

static void put_line(FILE *to, const Drawing *d, const CultureLine *l)
{
    fputs("[", to);
    for (int k = 0; k < l->corners; k++) {
        const double *p = d->culture->corner_m[l->first_corner + k];
        if (k) fputs(", ", to);
        put_place(to, d->from, p[0], p[1]);
    }
    fprintf(to,
            "]}, \"properties\": {\"record\": \"line\", \"kind\": \"%s\", \"width_m\": %.3f, \"height_m\": %.3f, "
            "\"surface\": \"%s\"}}",
            culture_line_name(l->kind), (double)l->width_m, (double)l->height_m,
            l->surface ? surface_name((SurfaceClass)l->surface) : "none");
}

static void put_all(FILE *to, const void *user)
{
    const Drawing *d = user;
    const Culture *c = d->culture;
    bool           more = false;
    fputs("{\"type\": \"FeatureCollection\", \"features\": [\n", to);
    for (int n = 0; n < c->buildings; n++) {
        begin(to, &more, c->building[n].id, "Polygon");
        put_building(to, d, &c->building[n]);
    }
    for (int n = 0; n < c->lines; n++) {
        begin(to, &more, c->line[n].id, "LineString");
        put_line(to, d, &c->line[n]);
    }
    for (int n = 0; n < c->points; n++) {
        const CulturePoint *p = &c->point[n];
        begin(to, &more, p->id, "Point");
        put_place(to, d->from, p->x_m, p->y_m);
        fprintf(
            to,
            "}, \"properties\": {\"record\": \"point\", \"kind\": \"%s\", \"base_m\": %.3f, \"size_m\": [%.3f, %.3f, "
            "%.3f], \"heading_rad\": %.4f}}",
            culture_point_name(p->kind), (double)p->base_m, (double)p->size_m[0], (double)p->size_m[1],
            (double)p->size_m[2], (double)p->heading_rad);
    }
    for (int n = 0; n < c->trees; n++) {
        const CultureTree *t = &c->tree[n];
        begin(to, &more, t->id, "Point");
        put_place(to, d->from, t->x_m, t->y_m);
        fprintf(to,
                "}, \"properties\": {\"record\": \"tree\", \"kind\": \"%s\", \"height_m\": %.2f, \"marked\": \"%s\"}}",
                plant_name((PlantKind)t->kind), (double)t->height_m, plant_mark_name((PlantMark)t->mark));
    }
    fputs("\n]}\n", to);
}

Status culture_write_geojson(const char *path, const Culture *culture, const CultureFiles *from)
{
    return text_write_file("terrain culture", path, put_all, &(Drawing){culture, from});
}
