#!/usr/bin/env python3
"""Runs sgmp on broken decks: each must end with exit code 3 and say what is wrong and where.

usage: errors.py SGMP_EXECUTABLE
"""
import os
import re
import subprocess
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
DECK_ERROR = 3
# The mutation tool asks whether anything fails, not what.
FIRST_ENDS = os.environ.get("SGMP_TEST_FIRST_ENDS", "") not in ("", "0")

# deck without .inp: what must be found in the output, {d} stands for its path; (options, …) may come first
EXPECTED = {
    "after_continuation": [r"{d}:7:10: error: text after the continuation"],
    "assignment": [r"{d}:7:19: error: 'y=8': a formula assigns nothing: write == to compare", r"^1 error"],
    "axisymmetric": [r"{d}:3:18: error: there is no axis 'x' in an axisymmetric scene",
                     r"{d}:3:24: error: the grid begins at r = 1",
                     r"{d}:4:17: error: a wall on y- in an axisymmetric scene",
                     r"{d}:7:9: error: 'vector' has a component along y", r"{d}:7:9: error: gravity along r",
                     r"{d}:9:37: error: the block reaches beyond the axis",
                     r"{d}:10:59: error: the axis of a cylinder .* is z",
                     r"{d}:11:51: error: the sphere is neither about the axis nor beside it",
                     r"{d}:11:68: error: a body of revolution",
                     r"{d}:12:37: error: '0\.1\*y': unexpected 'y'", r"^11 error"],
    "axisymmetric_late": [r"{d}:2:1: error: 'dimension axisymmetric' comes after the card 'grid'", r"^1 error"],
    "axisymmetric_names": [r"{d}:2:18: error: there is no axis 'r' in 2D",
                           r"{d}:3:18: error: hoop=… does not go with dimension 2",
                           r"{d}:7:16: error: there is no axis 'r' in 2D", r"^3 error"],
    "axisymmetric_rotation": [r"{d}:4:34: error: rotation=exact does not go with dimension axisymmetric: no body of "
                              r"revolution", r"^1 error"],
    "bad_expression": [r"{d}:8:19: error: .*'yung'", r"did you mean 'young'"],
    "bad_number": [r"{d}:4:12: error: .*'abc'", r"numbers are written like"],
    "beyond_units": [r"{d}:6:41: warning: young = 1e60 is 1e66 in SI units",
                     r"{d}:7:1: error: unknown card 'nonsense'"],
    "binary": [r"{d}:1:1: error: not a text file"],
    "binary_tail": [r"{d}:6:1: error: not a text file"],
    "blast": [r"{d}:9:1: error: a blast must know what the numbers of the deck mean",
              r"{d}:9:28: error: the charge is not on the axis",
              r"{d}:10:20: error: 'charge' = -1 is out of range", r"{d}:11:1: error: card 'blast' needs 'charge'",
              r"{d}:12:7: error: body 'stone' is rigid: it bears no load",
              r"{d}:12:7: error: the particles of body 'stone' have no known faces",
              r"{d}:13:40: error: 'ground' is unknown for 'burst'",
              r"{d}:14:39: error: there is no face 'x\+'", r"^10 error"],
    "box": [r"{d}:3:17: error: cell=0.3 does not divide 1 between the walls x- and x\+",
            r"cell=0\.3333333333333 and cell=0\.25 fit$"],
    "section": [r"{d}:6:32: error: the normal has no direction", r"{d}:7:32: error: there is no such plane in 2D",
                r"{d}:8:9: error: there are two sections 'two'",
                r"{d}:9:45: error: there is no body 'b'", r"^4 error"],
    "rock": [r"{d}:6:9: error: there is no file", r"no constants of rock with a source are known here",
             r"{d}:7:15: error: 'rock' is unknown for 'kind'",
             r"johnson_holmquist and mohr_coulomb run with constants of your own"],
    "concrete": [r"{d}:6:98: error: pores are closed at a pressure not above",
                 r"{d}:8:136: error: the pressure of dense material falls",
                 r"{d}:10:119: error: material without pores is not denser",
                 r"{d}:12:138: error: 'young' means nothing for kind concrete",
                 r"{d}:14:97: error: material that is let go would give more",
                 r"{d}:17:1: error: 'pile' \(concrete\) fails by damage of its own",
                 r"{d}:15:1: error: the pressure of 'pile' is elastic already", r"^7 error"],
    "contact": [r"{d}:8:13: error: there is no body 'wal'", r"did you mean 'wall'",
                r"{d}:9:13: error: contact of a body with itself",
                r"{d}:11:1: error: there are two cards for this contact", r"{d}:12:24: error: 'middle'",
                r"{d}:13:14: error: the velocity of a rigid body cannot depend on position",
                r"{d}:14:1: error: body 'wall' is made rigid twice",
                r"{d}:15:23: error: 'friction' = -1 is out of range"],
    "contact_alone": [r"{d}:7:1: error: 'contact' in a deck with one body"],
    "contact_rigid": [r"{d}:10:1: error: contact of two rigid bodies"],
    "copies_plane": [r"{d}:5:62: error: the copies of a cylinder leave the axis",
                     r"{d}:6:53: error: the copies move towards the axis",
                     r"{d}:7:46: error: a body of revolution cannot be turned",
                     r"{d}:8:51: error: in the plane a body turns about z",
                     r"{d}:9:7: error: a revolved polygon is a solid", r"^5 error"],
    "continuation": [r"{d}:7:8: error: the file ends after a continuation"],
    "dimension": [r"{d}:2:11: error: .* out of range", r"\[1,3\]"],
    "dimension_word": [r"{d}:1:11: error: 'axisymetric' is unknown for 'value'", r"did you mean 'axisymmetric'"],
    "doubling": [r"{d}:21:17: error: what '\$p13\$p13' stands for has more than 10000 letters"],
    "duplicate_names": [r"{d}:7:10: error: there are two materials 'steel'",
                        r"{d}:8:6: error: there are two bodies 'bar'"],
    "empty": [r"{d}: error: the file has no cards"],
    "explosive": [r"{d}:7:1: error: explosive 'tnt' has no JWL equation", r"eos tnt jwl"],
    "far_away": [r"{d}:6:1: error: body 'far' reaches 0\.1\d+E\+8 cells from the grid's origin",
                 r"^1 error|remedy: move the body"],
    "extent_out_of_plane": [r"{d}:3:30: error: extent along z in 2D", r"^1 error"],
    "wallmotion": [r"{d}:5:21: error: the wall on x- would leave its place",
                   r"{d}:6:12: error: the wall on x\+ is not fixed",
                   r"{d}:7:18: error: the velocity of a wall cannot depend on position",
                   r"{d}:8:1: error: the wall on y- does not move",
                   r"{d}:9:12: error: there is no face z\+ in 2D", r"{d}:10:1: error: the wall on x- has two motions",
                   r"{d}:11:12: error: 'w\+' is unknown for 'face'",
                   r"{d}:5:1: error: wallmotion does not go with damping"],
    "wallfriction": [r"{d}:5:14: error: the wall on x- does not slip",
                     r"{d}:6:26: error: 'friction' = -1 is out of range",
                     r"{d}:8:1: error: the wall on x\+ has two frictions",
                     r"{d}:9:14: error: there is no face z\+ in 2D",
                     r"{d}:10:1: error: card 'wallfriction' needs 'friction'",
                     r"{d}:11:12: error: the wall on y- is not fixed",
                     r"{d}:12:17: error: the wall on x\+ would leave its place"],
    "wallfriction_line": [r"{d}:5:26: error: wallfriction does not go with dimension 1: nothing slides", r"^1 error"],
    "wallfriction_swirl": [r"{d}:5:26: error: wallfriction does not go with swirl=yes", r"^1 error"],
    "far_body": [r"{d}:6:1: error: body 'bar' reaches .*E\+11 cells from the grid's origin"],
    "erode": [r"{d}:7:28: error: 'plastic_strain' = 0 is out of range",
              r"{d}:7:40: error: 'time_step' = -1 is out of range",
              r"{d}:9:19: error: 'iron' does not fail", r"{d}:10:1: error: material 'iron' has two cards erode",
              r"{d}:12:26: error: 'rod' \(elastic\) has no plastic strain",
              r"{d}:14:1: error: nothing says when particles of 'tin' go",
              r"{d}:16:22: error: erode time_step=… does not go with update=usf",
              r"{d}:17:7: error: there is no material 'led'"],
    "failure": [r"{d}:8:19: error: 'pmin' = 1e9 is out of range",
                r"{d}:8:57: error: 'principal_stress' = -1 is out of range",
                r"{d}:8:38: error: 'plastic_strain' = 0 is out of range",
                r"{d}:6:1: error: nothing says when 'steel' fails",
                r"{d}:10:1: error: 'rod' \(elastic\) cannot fail",
                r"{d}:13:1: error: a fluid such as 'water' fails by pmin alone",
                r"{d}:16:1: error: material 'lead' has two cards failure",
                r"{d}:17:9: error: there is no material 'led'",
                r"{d}:20:52: error: cells of 0\.250* hold more elastic energy than a crack",
                r"use cells below 0\.777778E-3",
                r"{d}:22:29: error: the damage of 'tin' grows by Johnson and Cook's constants already",
                r"{d}:24:80: error: 'weibull' = 0\.4 is out of range", r"{d}:24:89: error: 'seed' = -1 is out of range",
                r"{d}:26:49: error: 'gold' carries everything when it has failed",
                r"{d}:29:1: error: a fluid such as 'oil' fails by pmin alone",
                r"{d}:35:52: error: 'spall_strain' = 1\.5 is out of range",
                r"{d}:37:35: error: 'toughness' = -1 is out of range",
                r"{d}:31:25: error: nothing says what tension 'chalk' bears when it opens slowly",
                r"{d}:33:20: error: spall_strain says at what tension it spalls",
                r"{d}:39:55: error: softening starts from a limit that stays",
                r"{d}:41:42: error: 'onyx' is ductile \(spall_strain\) and brittle",
                r"{d}:44:1: error: a fluid such as 'milk' fails by pmin alone",
                r"{d}:46:48: error: cells of 0\.250* hold more elastic energy",
                r"{d}:48:31: error: no plastic strain drives the failure of 'tape'",
                r"{d}:50:40: error: the heat of 'foil' \(steinberg_guinan\) follows the strain",
                r"{d}:53:1: error: a fluid such as 'wine' fails by pmin alone", r"^25 error"],
    "fluids": [r"{d}:5:1: error: fluid 'air' has no equation of state", r"eos air tait",
               r"{d}:6:42: error: 'viscosity' = -1 is out of range", r"{d}:8:25: error: 'gamma' = 1 is out of range",
               r"{d}:11:1: error: the initial state has no speed of sound",
               r"{d}:13:52: error: energy0 and pressure0 are both given",
               r"{d}:15:33: error: 'exponent' = 0\.5 is out of range",
               r"{d}:17:41: error: 'p_inf' = -1 is out of range",
               r"{d}:19:1: error: the initial state has no speed of sound",
               r"{d}:21:40: error: the pressure does not depend on the energy",
               r"{d}:23:\d+: error: .*'pressure0' means nothing for kind jwl"],
    "foreign_dyna": [r"{d}:1:1: error: this is a deck of LS-DYNA", r"^1 error"],
    "foreign_mpm": [r"{d}:1:1: error: this is a deck of MPM3D", r"^1 error"],
    "garbage": [r"{d}:1:1: error: unknown card", r"{d}: error: the deck has no card 'grid'"],
    "half_said": [r"{d}:5:1: error: card 'grid' needs 'cell'", r"{d}:5:8: error: the interval '0:0' is empty",
                  r"{d}:10:12: error: 'elastik' is unknown", r"{d}:11:53: error: 'ppc' = 0 is out of range",
                  r"{d}:12:23: error: there is no material 'n'", r"^8 error"],
    "include_bad": [r"included\.inp:6:1: error: unknown card 'metod'", r"did you mean 'method'"],
    "include_loop": [r"include_loop_2\.inp:1:9: error: .*include_loop\.inp' includes itself"],
    "interval": [r"{d}:3:18: error: the interval '1:0' is empty"],
    "melt": [r"{d}:6:42: error: the melting temperature is not above room temperature"],
    "long_line": [r"{d}:2:1: error: the line has 10001 letters, more than 10000", r"end it with &", r"^1 error"],
    "later_version": [r"{d}:1:14: error: the deck is of a later version of the deck language", r"^1 error"],
    "long_formula": [r"{d}:2:11: error: .*the formula is too long"],
    "misplaced_words": [r"{d}:2:22: error: unexpected 'x' in card 'grid'", r"= a key needs a value: x=",
                        r"{d}:3:12: error: unexpected 'soon'",
                        r"= keys are written key=value, e\.g\. time end=", r"^2 error"],
    "missing_cards": [r"{d}: error: the deck has no card '%s'" % card for card in ("grid", "time", "body")],
    "missing_include": [r"{d}:7:9: error: there is no file '.*nothing\.inp'"],
    "missing_cards_include": [r"{d}:3:9: error: there is no file '.*nothing\.inp'", r"^1 error"],
    "missing_key": [r"{d}:5:1: error: card 'material' needs 'young'"],
    "nan": [r"{d}:4:10: error: '1e999'", r"{d}:5:32: error: 'nan'", r"{d}:5:42: error: 'inf'"],
    "negative_density": [r"{d}:5:32: error: 'density' = -7850 is out of range"],
    "no_end": [r"{d}:4:1: error: the time has no end", r"add end="],
    "no_limit": [r"{d}:4:1: error: nothing limits the time step: no body can deform", r"time dt="],
    "no_material": [r"{d}:6:1: error: card 'body' needs 'material'"],
    "no_particles": [r"{d}:6:1: .*body 'bar' has no particles"],
    "not_constant": [r"{d}:3:11: error: .*depends on position or time"],
    "kept": [r"{d}:6:21: error: volumes=kept does not go with method gimp: particles relax to the centres",
             r"{d}:6:31: error: spin=carried has been taken out.*", r"write rotation=exact instead"],
    "normalised": [r"{d}:6:19: error: stress=normalised does not go with method mpm"],
    "not_lit": [r"{d}:5:1: error: nothing lights the explosive 'tnt'", r"add a card detonation"],
    "not_yet": [r"{d}:7:1: error: unknown card 'import'"],
    "only_comments": [r"{d}: error: the file has no cards"],
    "open_wall": [r"{d}:7:9: error: a wall on y-, which is open", r"grid y=lower:open"],
    "out_of_plane": [r"{d}:6:51: error: 'upper' has a component along z in 2D", r"{d}:7:21: error: 'z' has",
                     r"{d}:8:9: error: 'vector' has"],
    "output_intervals": [r"{d}:9:18: error: two intervals for vtu", r"^1 error"],
    "output_field": [r"{d}:7:26: error: 'stres'", r"did you mean 'stress'"],
    "outside_grid": [r"{d}:7:1: error: body 'bar' reaches out of the grid along x", r"widen the grid"],
    "overlap": [r"{d}:[67]:1: .*overlap"],
    "polygon": [r"{d}:5:35: error: '1' is not a point", r"{d}:6:35: error: a polygon of 2 corners",
                r"{d}:7:35: error: the sides of the polygon cross",
                r"{d}:8:41: error: the point '\(1\)' has one component",
                r"{d}:9:41: error: '\(1,2,3\)' has more than two components",
                r"{d}:10:35: error: the sides of the polygon cross, or one has no length", r"^6 error"],
    "polygon_axis": [r"{d}:6:35: error: the polygon reaches beyond the axis", r"^1 error"],
    "polygon_solid": [r"{d}:5:1: error: the polygon needs a 'length'",
                      r"{d}:6:36: error: the polygon reaches beyond its axis",
                      r"{d}:7:1: error: copies and offset come together",
                      r"{d}:8:57: error: the copies are all in one place",
                      r"{d}:9:67: error: the axis has no direction",
                      r"{d}:10:29: error: unknown key 'copies' of card 'intersect'",
                      r"{d}:11:50: error: rotation means nothing for particles from a file",
                      r"{d}:11:60: error: jitter means nothing",
                      r"{d}:11:71: error: copies means nothing", r"{d}:11:103: error: lattice_origin means nothing",
                      r"^10 error"],
    "initial_stress": [r"{d}:18:1: error: the card does not say which stress",
                       r"{d}:19:1: error: components and the weight of the ground are two ways",
                       r"{d}:20:1: error: the ground has no surface", r"{d}:21:34: error: 'k0' = -0\.1 is out of range",
                       r"{d}:22:25: error: the initial stress cannot depend on t",
                       r"{d}:23:24: error: there is no yz in 2D", r"{d}:23:1: error: 'heap' has two initial stresses",
                       r"{d}:27:1: error: 'pool' has two initial stresses",
                       r"{d}:24:16: error: the stress of 'ball' \(neo_hookean\) follows from",
                       r"{d}:25:16: error: the stress of 'rod' \(j2\) follows from",
                       r"{d}:26:1: error: 'pool' is a fluid",
                       r"{d}:27:34: error: 'pool' is a fluid: its pressure is the same all around",
                       r"{d}:28:16: error: 'plate' is rigid", r"{d}:29:16: error: there is no body 'heep'",
                       r"^14 error"],
    "initial_stress_weightless": [r"{d}:7:28: error: nothing weighs: there is no gravity", r"^1 error"],
    "parameter_reserved": [r"{d}:7:11: error: 'x' already means something"],
    "parameter_twice": [r"{d}:8:11: error: parameter 'h' is defined twice", r"{d}:7:11"],
    "parenthesis": [r"{d}:7:9: error: unbalanced parentheses"],
    "particle_columns": [r"particle_columns\.txt:3:1: .*not a particle \(5 numbers, not 4\)"],
    "particle_file": [r"particles\.txt:3:9: .*not a particle \('oops' is not a number\)"],
    "poisson": [r"{d}:5:57: error: 'poisson' = 0\.5 is out of range", r"\(-1,0\.5\)"],
    "quote": [r"{d}:7:7: error: the quote is not closed"],
    "repeated_card": [r"{d}:7:1: error: card 'time' is given twice", r"{d}:4:1"],
    "repeated_key": [r"{d}:3:16: error: 'cell' is given twice"],
    "soil": [r"{d}:5:74: error: 'friction' = 90 is out of range", r"{d}:6:86: error: 'cohesion' = -1 is out of range",
             r"{d}:7:87: error: the angle of dilatancy is above that of friction",
             r"{d}:8:98: error: the tension lies beyond the apex",
             r"{d}:9:1: error: the pressure of 'silt' is elastic already",
             r"{d}:12:72: error: 'friction' = 0 is out of range",
             r"{d}:13:85: error: the angle of dilatancy is above that of friction",
             r"{d}:14:96: error: the tension lies beyond the apex",
             r"{d}:16:1: error: 'mud' \(mohr_coulomb\) cannot fail"],
    "metals": [r"{d}:5:1: error: neither thermal_stress nor thermal_hardening is given",
               r"{d}:6:118: error: without specific_heat nothing warms",
               r"{d}:7:114: error: the melting temperature is not above room temperature",
               r"{d}:8:1: error: melt_slope and melt_gamma belong together",
               r"{d}:9:91: error: nothing says where it melts without pressure",
               r"{d}:10:92: error: the greatest yield stress is below the first",
               r"{d}:11:93: error: 'thermal_rate' means nothing for kind steinberg_guinan",
               r"{d}:12:96: error: without specific_heat nothing warms, or softens",
               r"{d}:14:59: error: particles of 'brass' keep no temperature",
               r"{d}:15:58: error: particles of 'slag' keep no temperature",
               r"{d}:16:78: error: 'yield_weibull' = 0\.4 is out of range",
               r"{d}:16:93: error: 'yield_seed' = -1 is out of range",
               r"{d}:17:73: error: 'yield_weibull' means nothing for kind elastic", r"^13 error"],
    "ceramics": [r"{d}:5:87: error: the stress at the elastic limit is not above the pressure there",
                 r"{d}:8:60: error: 'tension_limit' = -2e8 is out of range",
                 r"{d}:8:93: error: 'bulking' = 2 is out of range",
                 r"{d}:8:101: error: 'young' means nothing for kind johnson_holmquist",
                 r"{d}:11:1: error: 'pot' \(johnson_holmquist\) fails by damage of its own",
                 r"{d}:9:1: error: the pressure of 'pot' is elastic already",
                 r"{d}:13:1: error: card 'material' needs 'k1'", r"^7 error"],
    "clays": [r"{d}:5:64: error: 'critical_ratio' = 0 is out of range",
              r"{d}:5:84: error: 'compression_slope' = -0\.1 is out of range",
              r"{d}:5:104: error: 'swelling_slope' = 0 is out of range",
              r"{d}:5:117: error: 'void_ratio' = 0 is out of range",
              r"{d}:5:129: error: 'pressure0' = 0 is out of range",
              r"{d}:5:146: error: 'least_pressure' = 0 is out of range",
              r"{d}:6:45: error: 'poisson' = 0\.5 is out of range",
              r"{d}:6:153: error: 'overconsolidation' = 0\.9 is out of range",
              r"{d}:7:103: error: it swells as much as it was compressed",
              r"{d}:9:20: error: the preconsolidation is below pressure0",
              r"{d}:11:42: error: preconsolidation and overconsolidation are both given",
              r"{d}:12:141: error: 'young' means nothing for kind cam_clay",
              r"{d}:13:1: error: card 'material' needs 'pressure0'",
              r"{d}:14:1: error: the pressure of 'till' is elastic already",
              r"{d}:16:1: error: 'till' \(cam_clay\) cannot fail", r"^15 error"],
    "foams": [r"{d}:5:59: error: 'poisson' = 0\.5 is out of range", r"{d}:5:71: error: 'plateau' = 0 is out of range",
              r"{d}:5:89: error: 'plastic_poisson' = 0\.5 is out of range",
              r"{d}:5:110: error: 'linear_hardening' = -1 is out of range",
              r"{d}:5:127: error: 'densification' = -1 is out of range",
              r"{d}:6:24: error: 'densification_strain' = 0 is out of range",
              r"{d}:6:49: error: 'densification_exponent' = 0\.9 is out of range",
              r"{d}:7:71: error: the foam yields above its Young's modulus",
              r"{d}:8:1: error: card 'material' needs 'plateau'",
              r"{d}:9:1: error: card 'material' needs 'densification_strain'",
              r"{d}:10:116: error: 'plastic_poisson' = -0\.1 is out of range",
              r"{d}:10:127: error: 'yield' means nothing for kind crushable_foam",
              r"{d}:11:1: error: the pressure of 'tub' is elastic already",
              r"{d}:13:1: error: 'tub' \(crushable_foam\) cannot fail", r"^14 error"],
    "pores": [r"{d}:6:1: error: distention, crush_start and crush_end belong together",
              r"{d}:8:\d+: error: pores have closed before they begin to",
              r"{d}:10:1: error: porous material starts without pressure and heat",
              r"{d}:12:\d+: error: 'distention' = 1 is out of range",
              r"{d}:14:\d+: error: the temperature of porous material is not known",
              r"{d}:17:50: error: pore_speed is that of porous material",
              r"{d}:19:96: error: waves in porous material are slower than in the solid",
              r"{d}:21:100: error: pores yield more before crush_start than beyond",
              r"{d}:23:99: error: 'pore_speed' = 0 is out of range", r"^11 error"],
    "rubber": [r"{d}:5:41: error: 'c1' = 0 is out of range",
               r"{d}:6:56: error: such a rubber would collapse under pressure",
               r"{d}:7:61: error: 'young' means nothing for kind mooney_rivlin",
               r"{d}:8:1: error: the pressure of 'tyre' is elastic already"],
    "remove": [r"{d}:12:8: error: a card removes one body", r"{d}:13:8: error: body 'c' is rigid",
               r"{d}:14:8: error: parts of body 'b' are moved",
               r"{d}:15:15: error: 'time' = 0 is out of range",
               r"{d}:16:1: error: nothing that can be strained would be left",
               r"{d}:17:1: error: body 'a' has two cards remove"],
    "rigid": [r"{d}:10:20: error: a free body with a prescribed motion",
              r"{d}:10:30: error: a free body with a prescribed motion",
              r"{d}:11:14: error: the mass of a body whose motion is prescribed",
              r"{d}:12:17: error: nothing turns about x in 2D",
              r"{d}:12:27: error: the velocity of a rigid body cannot depend on position",
              r"{d}:13:23: error: 'mass' = 0 is out of range",
              r"{d}:14:20: error: nothing turns about y in 2D", r"{d}:15:18: error: 'about' without a rotation"],
    "several": [r"{d}:3:11: error: 'cell'", r"{d}:5:32: error: 'density'", r"{d}:5:41: error: 'young'",
                r"{d}:5:51: error: 'poisson'", r"{d}:7:1: error: unknown card 'wal'", r"{d}:8:15: error: unbalanced",
                r"{d}:9:8: error: 'cvs'", r"{d}:10:10: error: there is no body 'rod'"],
    "split": [r"{d}:6:30: error: particles of body 'bar' have sides of 1\.0+ cells", r"^1 error"],
    "split_most": [r"{d}:6:24: error: split_most bounds", r"add split=0\.75", r"^1 error"],
    "small_strain": [r"{d}:5:73: error: 'strain' means nothing for kind j2"],
    "swirl": [r"{d}:2:30: error: swirl=yes does not go with method gimp",
              r"{d}:2:30: error: swirl=yes does not go with flip<1",
              r"{d}:2:30: error: swirl=yes does not go with contact with friction",
              r"{d}:9:20: error: the initial velocity cannot depend on t", r"^4 error"],
    "swirl_none": [r"{d}:6:19: error: the scene has no swirl", r"^1 error"],
    "swirl_plane": [r"{d}:1:19: error: swirl=yes does not go with dimension 2: it is the motion around the axis",
                    r"^1 error"],
    "time_in_velocity": [r"{d}:7:17: error: the initial velocity cannot depend on t"],
    "tiny_cell": [r"{d}:6:1: error: body 'bar' reaches .* cells from the grid's origin"],
    "too_many_particles": [r"{d}:6:1: error: body 'bar' would have about 8e12 particles"],
    "too_many_round": [r"{d}:6:1: .*too many particles"],
    "unknown_card": [r"{d}:7:1: error: unknown card 'vellocity'", r"did you mean 'velocity'"],
    "unknown_dollar": [r"{d}:7:8: error: there is no parameter 'metod'"],
    "unknown_key": [r"{d}:3:6: error: unknown key 'cel' of card 'grid'", r"^  \| grid cel=0\.25 x=0:1$",
                    r"^  \|      \^$",
                    r"did you mean 'cell'"],
    "unknown_material": [r"{d}:6:25: error: there is no material 'stel'", r"did you mean 'steel'"],
    "vector": [r"{d}:7:9: error: .*more than three components", r"{d}:8:23: error: '': empty expression"],
    "whole_number": [r"{d}:6:51: error: 'ppc' = 1\.5 is not a whole number"],
    "word_as_number": [r"{d}:4:11: error: .*is the word 'fine', not a number"],
    "wrong_kind": [r"{d}:5:67: error: 'yield' means nothing for kind elastic"],
}
HELPERS = {"included", "include_loop_2"}  # included by others

# further cases: name, deck, options, what must be found
SETTINGS = [
    ("unknown setting", "not_constant", ["--set", "hh=1"], [r"--set:1:1: error: the deck has no parameter 'hh'"]),
    ("bad setting", "not_constant", ["--set", "hh"], [r"--set:1:1: error: a setting must be NAME=VALUE"]),
    ("setting without name", "not_constant", ["--set", "=1"], [r"--set:1:1: error: a setting must be NAME=VALUE"]),
    ("setting without value", "not_constant", ["--set", "hh="], [r"--set:1:1: error: a setting must be NAME=VALUE"]),
]


def run(executable, deck, options=()):
    """Exit code and all output of a check; a crash has a negative code."""
    with tempfile.TemporaryDirectory() as folder:
        done = subprocess.run([executable, deck, "--check", "--output", os.path.join(folder, "out"), *options],
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=60, check=False)
    return done.returncode, done.stdout.decode("utf-8", "replace")


def complaints(code, output, deck, patterns):
    """What is not as it should be."""
    found = []
    if code != DECK_ERROR:
        found.append(f"exit code {code}, expected {DECK_ERROR}")
    if re.search(r"Backtrace|SIG[A-Z]{3,}|runtime error|terminate called", output):
        found.append("it crashed")
    for pattern in patterns:
        if not re.search(pattern.replace("{d}", re.escape(deck)), output, re.MULTILINE):
            found.append(f"not found: {pattern}")
    return found


def main():
    if len(sys.argv) != 2:
        print(__doc__.strip(), file=sys.stderr)
        return 2
    executable = os.path.abspath(sys.argv[1])
    decks = {name[:-4] for name in os.listdir(HERE) if name.endswith(".inp")} - HELPERS
    failures = 0
    for name in sorted(decks ^ set(EXPECTED)):
        failures += 1
        print(f"FAIL {name}: a deck without expectation, or an expectation without deck")
    cases = [(name, os.path.join(HERE, name + ".inp"), [], EXPECTED[name]) for name in sorted(decks & set(EXPECTED))]
    cases += [(title, os.path.join(HERE, name + ".inp"), options, patterns)
              for title, name, options, patterns in SETTINGS]
    missing = os.path.join(HERE, "there_is_no_such.inp")
    cases.append(("missing file", missing, [], [r"there is no file '.*there_is_no_such\.inp'"]))
    cases.append(("directory", HERE, [], [r"is a directory"]))
    for name, deck, options, patterns in cases:
        code, output = run(executable, deck, options)
        found = complaints(code, output, deck, patterns)
        failures += bool(found)
        for line in found:
            print(f"FAIL {name}: {line}")
        if found:
            print("    " + output.replace("\n", "\n    "))
            if FIRST_ENDS:
                return 1
    print(f"{len(cases)} broken decks, {failures} failures")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
