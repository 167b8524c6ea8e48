/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file nav_belly.c
 * @brief Least clearance: costmap cell by costmap cell, looking closely only where it could be least.
 */
#include "nav_belly.h"

#include <math.h>

#include "nav_math.h"
#include "nav_minmax.h"

#define SIDE ((int32_t) NAV_CELLS_PER_COST_CELL)
#define NOTHING (-0.5 * NAV_ETA_NONE)
#define MIDDLE (0.5 * ((double) NAV_CELLS_PER_COST_CELL - 1.0))

/* Costmap cells kept to be looked at in the best order. */
#define UNDER_MAX 32U

/** Affine in a point of the ground: north and east of the pose, and above the plane. */
typedef struct
{
    double at_0;
    double per_north;
    double per_east;
    double per_above;
} affine_t;

/** The belly over the ground. */
typedef struct
{
    const nav_ground_t *ground;
    const nav_spanned_t *spanned;
    const nav_box_t *box;
    double enough_m;
    affine_t u_m; /* from the ROVER origin along the body's heading in the plane */
    affine_t v_m;
    affine_t free_m;             /* clearance in the middle state */
    double spread_0[NAV_WHEELS]; /* change of clearance over half a wheel's interval, */
    double spread_u[NAV_WHEELS]; /* affine in the place too */
    double spread_v[NAV_WHEELS];
    double spread_per_m;     /* how much the loss over all wheels can change with the place */
    double spread_per_above; /* and more of it per metre that ground stands off the plane */
    double off_plane;        /* all of that, with its place */
    /* from the middle of a costmap cell to the furthest heightmap cell in it: */
    double free_reach_m;   /* change of clearance without spread, */
    double spread_reach_m; /* of the loss over all wheels, */
    double tile_half_u_m;  /* and distances along the body's axes */
    double tile_half_v_m;
} belly_t;

/** The middle of a costmap cell, from the pose and from the ROVER origin along the body. */
typedef struct
{
    double north_m;
    double east_m;
    double u_m;
    double v_m;
} tile_place_t;

static double affine_at(const affine_t *affine, double north_m, double east_m, double above_m)
{
    return affine->at_0 + (affine->per_north * north_m) + (affine->per_east * east_m) +
           (affine->per_above * above_m);
}

/** Places seen from the body: the origin is lifted along z, and the body turned in the plane. */
static void place_axes(belly_t *belly, double turn_rad)
{
    const nav_ground_t *ground = belly->ground;
    const double lifted_m = belly->spanned->linkage.state[NAV_LINKAGE_HEIGHT] / ground->cos_slope;
    const double u_0_m = -lifted_m * ground->forward_up;
    const double v_0_m = -lifted_m * ground->right_up;
    const affine_t u_m = {u_0_m + (turn_rad * v_0_m),
                          ground->u_of_xy[0] + (turn_rad * ground->v_of_xy[0]),
                          ground->u_of_xy[1] + (turn_rad * ground->v_of_xy[1]),
                          ground->forward_up + (turn_rad * ground->right_up)};
    const affine_t v_m = {v_0_m - (turn_rad * u_0_m),
                          ground->v_of_xy[0] - (turn_rad * ground->u_of_xy[0]),
                          ground->v_of_xy[1] - (turn_rad * ground->u_of_xy[1]),
                          ground->right_up - (turn_rad * ground->forward_up)};
    belly->u_m = u_m;
    belly->v_m = v_m;
}

/** Clearance along the body's z axis in the middle state. */
static void place_clearance(belly_t *belly, double height_m)
{
    const nav_spanned_t *spanned = belly->spanned;
    const double per_u = spanned->cos_roll * spanned->sin_pitch;
    const double per_v = -spanned->sin_roll;
    const double per_eta = spanned->cos_roll * spanned->cos_pitch;
    const affine_t free_m = {
        (height_m + (per_eta * spanned->linkage.state[NAV_LINKAGE_HEIGHT])) +
            (per_u * belly->u_m.at_0) + (per_v * belly->v_m.at_0),
        (per_u * belly->u_m.per_north) + (per_v * belly->v_m.per_north),
        (per_u * belly->u_m.per_east) + (per_v * belly->v_m.per_east),
        ((per_u * belly->u_m.per_above) + (per_v * belly->v_m.per_above)) -
            (per_eta * belly->ground->cos_slope),
    };
    belly->free_m = free_m;
}

/** How far clearance at a place can fall below that of the middle state: convex in the place. */
static double spread_at_m(const belly_t *belly, double u_m, double v_m)
{
    double spread_m = 0.0;
    for (uint32_t wheel = 0U; wheel < (uint32_t) NAV_WHEELS; wheel++)
    {
        spread_m += fabs(belly->spread_0[wheel] + (belly->spread_u[wheel] * u_m) +
                         (belly->spread_v[wheel] * v_m));
    }
    return spread_m;
}

/** Derivatives of clearance by wheel height, over half of each wheel's interval. */
static void place_spread(belly_t *belly)
{
    const nav_spanned_t *spanned = belly->spanned;
    const double (*inverse)[NAV_WHEELS] = spanned->linkage.inverse;
    const double lift_m = spanned->linkage.state[NAV_LINKAGE_HEIGHT];
    const double sr = spanned->sin_roll;
    const double cr = spanned->cos_roll;
    const double sp = spanned->sin_pitch;
    const double cp = spanned->cos_pitch;
    const double roll_half = spanned->half[NAV_LINKAGE_ROLL];
    const double pitch_half = spanned->half[NAV_LINKAGE_PITCH];
    double per_u = 0.0;
    double per_v = 0.0;

    for (uint32_t wheel = 0U; wheel < (uint32_t) NAV_WHEELS; wheel++)
    {
        const double roll = inverse[NAV_LINKAGE_ROLL][wheel];
        const double pitch = inverse[NAV_LINKAGE_PITCH][wheel];
        const double half_m = spanned->wheel_half_m[wheel];
        belly->spread_0[wheel] = half_m * ((cr * cp * inverse[NAV_LINKAGE_HEIGHT][wheel]) -
                                           (lift_m * ((sr * cp * roll) + (cr * sp * pitch))));
        belly->spread_u[wheel] = half_m * ((cr * cp * pitch) - (sr * sp * roll));
        belly->spread_v[wheel] = -half_m * cr * roll;
        per_u += fabs(belly->spread_u[wheel]);
        per_v += fabs(belly->spread_v[wheel]);
    }
    belly->spread_per_m = per_u + per_v;
    /* attitude acts on eta, and on a slope a cell stands rise * eta from its foot */
    belly->spread_per_above =
        belly->ground->cos_slope *
        ((fabs(sr) * roll_half) + (fabs(sp) * pitch_half) +
         (0.5 * ((roll_half * roll_half) + (pitch_half * pitch_half))) +
         (per_u * fabs(belly->ground->rise_forward)) + (per_v * fabs(belly->ground->rise_right)));
}

/** How far numbers change within a costmap cell. */
static void place_reach(belly_t *belly)
{
    const double half_m = MIDDLE * belly->ground->surface->cell_m;
    belly->free_reach_m = half_m * (fabs(belly->free_m.per_north) + fabs(belly->free_m.per_east));
    belly->spread_reach_m = belly->spread_per_m * 1.5 * half_m;
    belly->tile_half_u_m = half_m * (fabs(belly->u_m.per_north) + fabs(belly->u_m.per_east));
    belly->tile_half_v_m = half_m * (fabs(belly->v_m.per_north) + fabs(belly->v_m.per_east));
}

/** Does ground at a place seen from the body lie in the box along the body's axes? */
static bool is_under(const belly_t *belly, double u_m, double v_m, double above_m)
{
    const nav_spanned_t *spanned = belly->spanned;
    const nav_box_t *box = belly->box;
    const double up_m =
        (above_m * belly->ground->cos_slope) - spanned->linkage.state[NAV_LINKAGE_HEIGHT];
    const double along_m = (spanned->cos_pitch * u_m) + (spanned->sin_pitch * up_m);
    const double across_m =
        (spanned->sin_roll * ((spanned->sin_pitch * u_m) - (spanned->cos_pitch * up_m))) +
        (spanned->cos_roll * v_m);
    return (fabs(along_m - box->u_m) <= box->half_u_m) &&
           (fabs(across_m - box->v_m) <= box->half_v_m);
}

/** Lowers the least clearance by one heightmap cell, of which the clearance without spread is known. */
static void lower_by_cell(const belly_t *belly,
                          double north_m,
                          double east_m,
                          double above_m,
                          double free_m,
                          double *least_m)
{
    const double u_m = affine_at(&belly->u_m, north_m, east_m, above_m);
    const double v_m = affine_at(&belly->v_m, north_m, east_m, above_m);
    const double left_m =
        free_m - spread_at_m(belly, u_m, v_m) - (belly->spread_per_above * fabs(above_m));
    if ((left_m < *least_m) && is_under(belly, u_m, v_m, above_m))
    {
        *least_m = left_m;
    }
}

/** Does a place of the plane lie in the box? */
static bool is_foot_under(const belly_t *belly, double north_m, double east_m)
{
    const nav_box_t *box = belly->box;
    return (fabs(affine_at(&belly->u_m, north_m, east_m, 0.0) - box->u_m) <= box->half_u_m) &&
           (fabs(affine_at(&belly->v_m, north_m, east_m, 0.0) - box->v_m) <= box->half_v_m);
}

/** Looks at every heightmap cell of a costmap cell. @return the number of those not known in the box */
static uint32_t lower_by_cells(
    const belly_t *belly, int32_t cost_row, int32_t cost_col, double spread_m, double *least_m)
{
    const nav_ground_t *ground = belly->ground;
    const affine_t *free_m = &belly->free_m;
    const double cell_m = ground->surface->cell_m;
    const int32_t first_row = (cost_row * SIDE) - ground->cost_row;
    const int32_t first_col = (cost_col * SIDE) - ground->cost_col;
    const double first_east_m = ((double) first_col - ground->col) * cell_m;
    uint32_t unknown_count = 0U;
    for (int32_t row = first_row; row < (first_row + SIDE); row++)
    {
        const float *z_site_m = &ground->surface->z_site_m[(row * NAV_HEIGHTMAP_SIZE) + first_col];
        const double north_m = ((double) row - ground->row) * cell_m;
        double plane_m =
            ground->z_site_m + (ground->dz_dx * north_m) + (ground->dz_dy * first_east_m);
        double level_m = affine_at(free_m, north_m, first_east_m, 0.0);
        for (int32_t col = 0; col < SIDE; col++)
        {
            const double above_m = plane_m - (double) z_site_m[col];
            const double left_m = level_m + (free_m->per_above * above_m);
            if (above_m < NOTHING)
            {
                unknown_count +=
                    is_foot_under(belly, north_m, first_east_m + ((double) col * cell_m)) ? 1U : 0U;
            }
            else if ((left_m - spread_m) < *least_m)
            {
                lower_by_cell(belly, north_m, first_east_m + ((double) col * cell_m), above_m,
                              left_m, least_m);
            }
            else
            {
                /* cannot be the least */
            }
            plane_m += ground->dz_dy * cell_m;
            level_m += free_m->per_east * cell_m;
        }
    }
    return unknown_count;
}

/** Largest spread of all ground at the level of the plane in a box: it is convex, so that of a corner. */
static double spread_over_m(const belly_t *belly, const nav_box_t *feet)
{
    const double front_m = feet->u_m + feet->half_u_m;
    const double rear_m = feet->u_m - feet->half_u_m;
    const double left_m = feet->v_m - feet->half_v_m;
    const double right_m = feet->v_m + feet->half_v_m;
    return nav_max(
        nav_max(spread_at_m(belly, front_m, left_m), spread_at_m(belly, front_m, right_m)),
        nav_max(spread_at_m(belly, rear_m, left_m), spread_at_m(belly, rear_m, right_m)));
}

/** A costmap cell that the belly touches. */
typedef struct
{
    int32_t row;
    int32_t col;
    double spread_m; /* largest of what stands in it */
    double free_m;   /* least clearance that it can hold */
} under_t;

/** What the belly touches, and what is known of it so far. */
typedef struct
{
    double spread_m;        /* largest of all ground at the level of the plane */
    double least_m;         /* clearance */
    uint32_t unknown_count; /* heightmap cells in the box */
    uint32_t count;         /* of those to look at later */
    uint32_t best;          /* that which could be least */
    under_t cells[UNDER_MAX];
} search_t;

static void look_at(const belly_t *belly, const under_t *cell, search_t *search)
{
    search->unknown_count +=
        lower_by_cells(belly, cell->row, cell->col, cell->spread_m, &search->least_m);
}

/** Takes a cell for later, or looks at it at once where there is no room for more. */
static void take(const belly_t *belly, const under_t *cell, search_t *search)
{
    if (search->count < UNDER_MAX)
    {
        search->cells[search->count] = *cell;
        search->best =
            (cell->free_m < search->cells[search->best].free_m) ? search->count : search->best;
        search->count++;
    }
    else
    {
        look_at(belly, cell, search);
    }
}

/** Takes a costmap cell as a whole where it leaves enough, or else to be looked at. */
static void touch(const belly_t *belly, under_t *cell, const tile_place_t *place, search_t *search)
{
    const nav_tile_t tile =
        nav_ground_tile(belly->ground, cell->row, cell->col, place->north_m, place->east_m);
    /* what stands off the plane has more spread */
    const double off_m =
        belly->off_plane * nav_max(fabs(tile.above.low_m), fabs(tile.above.high_m));
    const double free_m =
        affine_at(&belly->free_m, place->north_m, place->east_m, tile.above.high_m) -
        belly->free_reach_m;
    const double left_m = free_m - (search->spread_m + off_m);
    if (tile.is_whole && (left_m >= belly->enough_m))
    {
        search->least_m = nav_min(search->least_m, left_m);
    }
    else
    {
        const double spread_m =
            spread_at_m(belly, place->u_m, place->v_m) + belly->spread_reach_m + off_m;
        cell->spread_m = tile.is_whole ? spread_m : NAV_ETA_NONE;
        cell->free_m = tile.is_whole ? (free_m - spread_m) : -NAV_ETA_NONE;
        take(belly, cell, search);
    }
}

/** Finds the costmap cells that the belly touches: that can hold ground under it. */
static void find_touched(const belly_t *belly,
                         const nav_box_t *feet,
                         const nav_cost_box_t *cells,
                         search_t *search)
{
    search->spread_m = spread_over_m(belly, feet);
    search->least_m = NAV_ETA_NONE;
    search->unknown_count = 0U;
    search->count = 0U;
    search->best = 0U;
    for (int32_t row = cells->rows.first; row <= cells->rows.last; row++)
    {
        tile_place_t place = {.north_m = nav_ground_tile_north_m(belly->ground, row)};
        for (int32_t col = cells->cols.first; col <= cells->cols.last; col++)
        {
            place.east_m = nav_ground_tile_east_m(belly->ground, col);
            place.u_m = affine_at(&belly->u_m, place.north_m, place.east_m, 0.0);
            place.v_m = affine_at(&belly->v_m, place.north_m, place.east_m, 0.0);
            if ((fabs(place.u_m - feet->u_m) <= (feet->half_u_m + belly->tile_half_u_m)) &&
                (fabs(place.v_m - feet->v_m) <= (feet->half_v_m + belly->tile_half_v_m)))
            {
                under_t cell = {row, col, 0.0, 0.0};
                touch(belly, &cell, &place, search);
            }
        }
    }
}

/** Number of heightmap cells that fit in the box. */
static double cells_in_box(const belly_t *belly)
{
    const double cell_m = belly->ground->surface->cell_m;
    return nav_max((4.0 * belly->box->half_u_m * belly->box->half_v_m * belly->ground->cos_slope) /
                       (cell_m * cell_m),
                   1.0);
}

/** Looks first where clearance could be least, then wherever it could be less still. */
static nav_clearance_t clearance_over(const belly_t *belly,
                                      const nav_box_t *feet,
                                      const nav_cost_box_t *cells)
{
    search_t search;
    nav_clearance_t clearance = {NAV_ETA_NONE, 1.0};
    find_touched(belly, feet, cells, &search);
    if (search.count > 0U)
    {
        look_at(belly, &search.cells[search.best], &search);
    }
    for (uint32_t k = 0U; k < search.count; k++)
    {
        if ((k != search.best) && (search.cells[k].free_m < search.least_m))
        {
            look_at(belly, &search.cells[k], &search);
        }
    }
    clearance.clearance_min_m = search.least_m;
    if (search.least_m < NAV_ETA_NONE)
    {
        clearance.unknown = nav_min((double) search.unknown_count / cells_in_box(belly), 1.0);
    }
    return clearance;
}

nav_clearance_t nav_belly_clearance(const nav_ground_t *ground,
                                    const nav_spanned_t *spanned,
                                    const nav_box_t *box,
                                    double height_m,
                                    double turn_rad,
                                    double enough_m)
{
    const double lifted_m = spanned->linkage.state[NAV_LINKAGE_HEIGHT] / ground->cos_slope;
    const double lean_u = fabs(spanned->linkage.state[NAV_LINKAGE_PITCH]) +
                          spanned->half[NAV_LINKAGE_PITCH] + fabs(ground->rise_forward);
    const double lean_v = fabs(spanned->linkage.state[NAV_LINKAGE_ROLL]) +
                          spanned->half[NAV_LINKAGE_ROLL] + fabs(ground->rise_right);
    belly_t belly = {.ground = ground, .spanned = spanned, .box = box, .enough_m = enough_m};
    nav_box_t feet = *box;
    nav_cost_box_t cells;
    nav_clearance_t clearance = {NAV_ETA_NONE, 1.0};

    feet.half_u_m += NAV_STAND_MAX_M * lean_u;
    feet.half_v_m += NAV_STAND_MAX_M * lean_v;
    place_axes(&belly, turn_rad);
    place_clearance(&belly, height_m);
    place_spread(&belly);
    belly.off_plane =
        belly.spread_per_above +
        (belly.spread_per_m * nav_max(fabs(belly.u_m.per_above), fabs(belly.v_m.per_above)));
    place_reach(&belly);
    /* the same feet, seen from the pose */
    nav_box_t around = feet;
    around.u_m += lifted_m * ground->forward_up;
    around.v_m += lifted_m * ground->right_up;
    around.half_u_m += fabs(turn_rad) * feet.half_v_m;
    around.half_v_m += fabs(turn_rad) * feet.half_u_m;
    if (nav_ground_cost_box(ground, &around, &cells))
    {
        clearance = clearance_over(&belly, &feet, &cells);
    }
    return clearance;
}
