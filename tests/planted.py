# ruff: noqa: E501
"""Bugs that were planted once and must still be caught: text of the package, what replaces it, tests.

Each text stands once in segmap, in whatever file it is now. The tests are the files that must fail:
`angles` is `tests/test_angles.py`; none means those of the room.
"""

PLANTED = (
    # angles and poses: a wrap, a sign, a half turn
    ("+ np.pi / 2) % np.pi - np.pi / 2\n\n\ndef axial_mean(", "+ np.pi / 2) % (2 * np.pi) - np.pi / 2\n\n\ndef axial_mean(", "angles"),
    ("% (2 * np.pi) - np.pi\n\n\ndef axial", "% (2 * np.pi)\n\n\ndef axial", "angles"),
    ("found = np.arctan2(y, x) / 2 % np.pi", "found = np.arctan2(y, x) % np.pi", "angles"),
    ("x = -c * p[..., 0] - s * p[..., 1]", "x = -c * p[..., 0] + s * p[..., 1]", "poses"),
    ("wrap(a[..., 2] + b[..., 2])", "a[..., 2] + b[..., 2]", "poses"),
    ("(span <= max_gap)", "(span < max_gap)", "poses"),
    # extraction
    ("(b[1] - a[1]) ** 2 >= gap * gap", "(b[1] - a[1]) ** 2 > gap * gap", "extraction"),
    ("turn = 0.5 * np.arctan2(2 * sxy, sxx - syy)", "turn = 0.5 * np.arctan2(sxy, sxx - syy)", "extraction"),
    ("if first < 0 and _is_cut(p[i - 1], p[i], gap):", "if first < 0 and i and _is_cut(p[i - 1], p[i], gap):", "extraction"),
    # distance and quality
    ("if APART * (dx - reach) >= best:", "if dx - reach >= best:", "metrics"),
    ("if dot < 0.0:\n", "if dot > 0.0:\n", "metrics"),
    ("if abs(dot) <= PERPENDICULAR:", "if abs(dot) <= -PERPENDICULAR:", "metrics"),
    ("np.where(wanted - t[before] <= t[after] - wanted, before, after)", "np.where(wanted - t[before] < t[after] - wanted, before, after)", "metrics"),
    # Basic
    ("turn = (state.angles[a] - state.angles[b] + np.pi / 2) % np.pi - np.pi / 2", "turn = state.angles[a] - state.angles[b]", "basic"),
    ("turn = (state.angles[b] - state.angles[a] + np.pi / 2) % np.pi - np.pi / 2", "turn = state.angles[b] - state.angles[a]", "basic"),
    ("if dx * dx + dy * dy >= distance * distance:", "if dx * dx + dy * dy > distance * distance:", "basic"),
    ("return abs(turn) < angle\n", "return abs(turn) < np.radians(angle)\n", "basic reduction_properties"),
    ("heapq.heappush(heap if b > a else later, b)", "heapq.heappush(heap, b)", "basic"),
    # Hybrid
    ("line[0] = (line[2] * line[0] + sign * rho) / (line[2] + 1)", "line[0] = (line[2] * line[0] + rho) / (line[2] + 1)", "hybrid"),
    ("if 0.0 <= along <= length * length:", "if along <= length * length:", "hybrid"),
    ("line[1] = (line[2] * line[1] + theta + turns * np.pi) / (line[2] + 1)", "line[1] = (line[2] * line[1] + theta) / (line[2] + 1)", "hybrid"),
    ("if b < best if tie else near < least:", "if near < least:", "hybrid"),
    ("np.where(turns % 2 == 0, rho, -rho)", "rho", "hybrid"),
    # mean shift
    ("da = da - period if da >= half else da", "da = da", "mean_shift"),
    ("np.ceil(length(segments) / sigma - 1e-9)", "np.ceil(length(segments) / sigma)", "mean_shift"),
    ("if dx * dx + dy * dy + da * da < reach * reach:", "if dx * dx + dy * dy < reach * reach:", "mean_shift"),
    ("if count == 0 or low[i] > end[count - 1] + SAME:", "if count == 0 or low[i] > end[count - 1] - SAME:", "mean_shift"),
    # Fusion
    ("edge = measured[i, 2] + half if k % 2 else measured[i, 3] - half", "edge = measured[i, 3] - half", "fusion"),
    ("if measured[i, 0] > reach + SAME:", "if measured[i, 0] > reach - SAME:", "fusion"),
    ("if shifts[k, 1] < most - SAME or abs(shift) > least + SAME:", "if shifts[k, 1] < most - SAME:", "fusion"),
    # pose graph
    ("left[..., 2] = wrap(left[..., 2])", "left[..., 2] = left[..., 2]", "graph"),
    ("blocks[:, 1, 0, 1] = np.sin(heading)", "blocks[:, 1, 0, 1] = -np.sin(heading)", "graph"),
    ("1.4826 * 0.5 *", "0.5 *", "match_points point_map"),
    ("if a.second == b.second or abs(path[a.second] - path[b.second]) > rules.stretch:", "if abs(path[a.second] - path[b.second]) > rules.stretch:", "pose_graph"),
    ("return bool(np.hypot(x, y) < rules.tolerance and abs(heading) < rules.angle)", "return True", "pose_graph"),
    ("found[:, 1], -found[:, 0]", "-found[:, 1], found[:, 0]", "graph"),
    ("+ (deviations(poses, edges) / scale) ** 2)", "+ (deviations(poses, edges) / scale) ** 4)", "graph"),
    ("np.linalg.inv(covariance + REAL)", "np.linalg.inv(covariance + 1e-12 * REAL)", "graph"),
    ("np.arange(len(start)), side=\"right\") - 1", "np.arange(len(start)), side=\"left\") - 1", "graph"),
    ("range(int(reach / grid.size) + 2)", "range(int(reach / grid.size) + 1)", "point_map"),
    ("rows[used, 2] = ny * turned_x - nx * turned_y", "rows[used, 2] = ny * x - nx * y", "point_map"),
    ("_ranked(size, used, (used - 1) // 2)", "middle", "point_map"),
    ("if a[k, k] > FREE * most:", "if a[k, k] > 1e-9 * most:", "match_points"),
    ("or (grid.sided and behind)", "", "point_map"),
    ("near / ((len(current) + stride - 1) // stride)", "near / len(current)", "point_map"),
    ("if a <= radius and b <= radius:", "if a <= radius:", "point_map"),
    ("wide, step = levels[k + 1], 1 << k", "wide, step = levels[k + 1], 1", "point_map"),
    (" & (path > rules.min_path)", "", "pose_graph"),
    ("return Edge(window.old, new, match.pose", "return Edge(new, window.old, match.pose", "pose_graph"),
    ("self.lost_since = self.lost_since if confirmed else new", "self.lost_since = None", "pose_graph"),
    ("if best.free is None or map.has_wall_facing", "if True or map.has_wall_facing", "pose_graph"),
    ("PointMap(points, viewpoints)", "PointMap(points)", "pose_graph"),
    # quadtree and matching: see the end of the list
    # readers
    ("endpoint=count % 2 == 1", "endpoint=True", "readers readers_real readers_formats"),
    ("np.where(ranges >= limit, np.inf, np.where(ranges > 0, ranges, np.nan))", "np.where(ranges > limit, np.inf, np.where(ranges > 0, ranges, np.nan))", ""),
    ("(np.arange(count, dtype=float) - (count - 1) / 2) * step", "(np.arange(count, dtype=float) - count / 2) * step", "readers_formats readers_player readers_real"),
    ("step = resolution or field_of_view / max(beams - 1, 1)", "step = resolution or field_of_view / max(beams, 1)", "readers readers_formats readers_real"),
    ("if rear and np.cos(turn) >= 0:", "if rear and np.cos(turn) < 0:", "readers readers_formats readers_real exports"),
    # the laser
    ("checksum(line[:-1]) != line[-1:]", "False", "hokuyo sensor_damage"),
    ("step = first + np.arange(count) * cluster + (cluster - 1) / 2", "step = first + np.arange(count) * cluster + (cluster - 1) // 2", "hokuyo"),
    ("return self.last - self.first + 1\n", "return self.last - self.first\n", "hokuyo sensor_damage"),
    ("if any(len(block) != BLOCK for block in blocks[:-1])", "if any(False for block in blocks[:-1])", "hokuyo sensor_damage"),
    # simulation
    ("if (side_a < 0) == (side_b < 0) and side_a != 0 and side_b != 0:", "if (side_a < 0) == (side_b < 0):", "simulation"),
    ("if TOUCH < ahead < ranges[i] and ahead <= max_range:", "if TOUCH < ahead and ahead <= max_range:", "simulation"),
    ("(angle < sensor.grazing)", "(angle > sensor.grazing)", "simulation"),
    ("here[2] + wrap(heading - here[2])", "heading", "simulation"),
    # exports
    ("np.select([value > occupied, value <= free], [2.0, 0.0], 1.0)", "np.select([value >= occupied, value <= free], [2.0, 0.0], 1.0)", "exports_maps"),
    ("{np.sin(heading / 2):.9f} {np.cos(heading / 2):.9f}", "{np.cos(heading / 2):.9f} {np.sin(heading / 2):.9f}", "exports"),
    # more of the laser, readers, simulation and exports
    ("(sum(text) & 63) + ZERO", "(sum(text) & 31) + ZERO", "hokuyo"),
    ("if strict and not (end and colon", "if False and not (end and colon", "hokuyo"),
    ("since + WRAP * max(round(", "since + 0 * max(round(", "hokuyo"),
    ("if request.streams and reply.status == \"00\":", "if False:", "sensor_faults"),
    ("if count not in (request.beams, request.steps // request.cluster):", "if False:", "sensor_damage"),
    ("self._leave = weakref.finalize(self, leave, lines)", "self._leave = weakref.finalize(self, id, lines)", "sensor_terminal"),
    ("wait = min(2 * wait, BACK_OFF[1])", "wait = min(wait, BACK_OFF[1])", "sensor_damage"),
    ("if self._running is not request:", "if self._running is None:", "sensor"),
    ("        numbers.append(signal.SIGHUP)", "        pass", "sensor_terminal"),
    ("            signal.signal(number, signal.SIG_IGN)", "            pass", "sensor_terminal"),
    ("_write_all(file, b\"#\" + line[1:] + b\"\\n\")", "_write_all(file, line + b\"\\n\")", "record"),
    ("part = folder / f\".scan.{os.getpid()}.part\"", "part = folder / f\"scan{number:06}.txt\"", "record"),
    ("request._replace(scans=max(request.scans - 1, 0))", "request", "emulator"),
    ("(step - self.front) * 2 * np.pi / self.steps", "(self.front - step) * 2 * np.pi / self.steps", "sensor"),
    ("*[Meaning(\"another error\", np.nan)] * 6,", "*[Meaning(\"another error\", np.inf)] * 6,", "error_codes"),
    ("largest = max((float(r[np.isfinite(r)]", "largest = min((float(r[np.isfinite(r)]", "readers"),
    ("            turn += np.pi\n", "            turn += 0.0\n", "readers"),
    ("Extrinsic(offset, compose(poses, inverse(offset)))", "Extrinsic(offset, poses)", "readers"),
    ("turn = (right - left) / WHEEL_SEPARATION", "turn = (left - right) / WHEEL_SEPARATION", "readers_formats"),
    ("np.radians(quarters / 4)", "np.radians(quarters)", "readers_formats"),
    ("for tolerance in (1e-6, 6e-5):", "for tolerance in ():", "readers_player"),
    ("if TOUCH < ahead < ranges[i] and", "if -1.0 < ahead < ranges[i] and", "simulation"),
    ("noise.turn_noise * np.sqrt(turn) * chance[1]", "noise.turn_noise * chance[1]", "simulation"),
    ("compose(truth, offset), drifted", "compose(offset, truth), drifted", "simulation"),
    ("np.flipud(found.greys)", "found.greys", "exports_maps"),
    ("_numbers(np.concatenate([compose(pose, scan.sensor_pose), odometry]))", "_numbers(np.concatenate([pose, odometry]))", "exports"),
)  # fmt: skip
