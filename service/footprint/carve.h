#pragma once

#include "service/footprint/footprint.h"

namespace soffit {

/// The outline of a silhouette on the plane z = `height_m`: counter-clockwise, holes clockwise. `outer` is
/// empty when it reaches above the horizon.
Polygon ProjectOutline(const Silhouette& silhouette, double height_m);

/// The largest region of the ground on which plumb walls of this height stay within the silhouette: what the
/// lean of walls and roof added to a footprint is carved off, notches included. Where the lean fills a notch
/// wholly the picture does not show it. Largest piece only; `outer` is empty when nothing is left.
///
/// A point stays when the picture of the plumb line on it does not leave the silhouette, so what goes is
/// swept by the sides that face away from the camera when they sink from the roof to the ground. Drawn on a
/// grid and fitted again: right to a pixel or so. Pure.
Polygon Carve(const Silhouette& silhouette, double height_m);

/// `ring`, carved from `silhouette`, without the dents that openings made: ground that shows through an
/// opening of a wall dents the silhouette as a notch of the building would. It is an opening when the wall
/// goes on in one line behind the dent and `all` silhouettes that show the building whole show the roof over
/// the dent.
Ring CloseOpenings(Ring ring, const Silhouette& silhouette, const std::vector<Silhouette>& all,
                   double height_m);

/// What any of the polygons covers, drawn on a grid as by Carve. Largest piece only; `outer` is empty when
/// nothing is covered.
Polygon Unite(const std::vector<Polygon>& polygons, double least_cell_m);

/// The height of every side of the silhouette, taken for an upright edge from the ground to the roof, that
/// runs radially from the point beneath the camera as such edges do. Others that happen to do so are among
/// them.
std::vector<double> HeightsOfUprightSides(const Silhouette& silhouette);

/// Metres on the ground per pixel, at the middle of the silhouette.
double GroundSampling_m(const Silhouette& silhouette);

}  // namespace soffit
