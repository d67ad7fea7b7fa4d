"""Files of poses: how they are written, and what they are to a log."""

import numpy as np
import pytest
from log_samples import text

import segmap
from segmap import readers
from segmap.readers import LogError

POSES = np.array([(0.0, 1.0, 0.1), (1.0, 2.0, 0.5), (2.0, 2.0, -0.5)])
TIMES = 1.6e9 + np.arange(3)


def rows(line):
    return text(line(t, *pose) for t, pose in zip(TIMES, POSES, strict=True))


def turned(heading):
    return f"0 0 {np.sin(heading / 2):.9f} {np.cos(heading / 2):.9f}"


FILES = {
    "tum": rows(lambda t, x, y, h: f"{t:.3f} {x} {y} 0 {turned(h)}"),
    "tum with a head": "# timestamp tx ty tz qx qy qz qw\n"
    + rows(lambda t, x, y, h: f"{t:.3f} {x} {y} 0 {turned(h)}"),
    "bare": rows(lambda t, x, y, h: f"{t:.3f},{x},{y},{h}"),
    "named": "theta,y,x,t\n" + rows(lambda t, x, y, h: f"{h},{y},{x},{t:.3f}"),
    "degrees": "time_s;x [m];y [m];yaw_deg\n"
    + rows(lambda t, x, y, h: f"{t:.3f};{x};{y};{np.degrees(h):.6f}"),
    "decimal commas": "t;x;y;yaw\n"
    + rows(lambda t, x, y, h: f"{t:.3f};{x};{y};{h}").replace(".", ","),
    "euroc": "#timestamp [ns],p_RS_R_x [m],p_RS_R_y [m],p_RS_R_z [m],q_RS_w [],q_RS_x [],"
    "q_RS_y [],q_RS_z []\n"
    + rows(lambda t, x, y, h: f"{int(t)}000000000,{x},{y},0,{np.cos(h / 2)},0,0,{np.sin(h / 2)}"),
    "texts": "Timestamp,px,py,yaw\n"
    + rows(lambda t, x, y, h: f"2020-09-13T12:26:{40 + t - 1.6e9:02.0f}Z,{x},{y},{h}"),
}


@pytest.mark.parametrize("name", FILES)
def test_poses_are_read_however_they_are_written(tmp_path, name):
    """Catches a column that is another, a quaternion in another order, and degrees."""
    path = tmp_path / "it.txt"
    path.write_text(FILES[name])
    times, poses = readers.read_trajectory(path)
    assert times == pytest.approx(TIMES) and poses == pytest.approx(POSES, abs=1e-5)


def test_poses_are_odometry_and_truth_at_the_times_of_the_scans(tmp_path):
    """Catches poses by their number, and those that are made up beside what the file covers."""
    path = tmp_path / "it.tum"
    path.write_text(FILES["tum"])
    shots = [segmap.LaserScan([1.0], [0.0], time=t) for t in (TIMES[0] + 0.5, TIMES[2] + 0.1)]
    log = readers.with_trajectories(segmap.Log("it", shots), odometry=path, truth=path)
    for found in (log.odometry, log.truth):
        assert found[0] == pytest.approx([0.5, 1.5, 0.3]) and np.isnan(found[1]).all()
    assert log.track[:, 0] == pytest.approx(TIMES) and log.assumed == (
        "poses of it.tum are the robot's",
    )
    late = segmap.Log("it", [segmap.LaserScan([1.0], [0.0], time=5.0)])
    with pytest.raises(LogError, match="it has another clock"):
        readers.with_trajectories(late, truth=path)
    with pytest.raises(LogError, match="the scans of the log have no times"):
        readers.with_trajectories(
            segmap.Log("it", [segmap.LaserScan([1], [0], np.nan)]), truth=path
        )


def test_what_holds_no_poses_is_told(tmp_path):
    path = tmp_path / "it.csv"
    for content, said in (("a,b\n", "13 columns of ground truth"), ("", "holds no pose")):
        path.write_text(content)
        with pytest.raises(LogError, match=said):
            readers.read_trajectory(path)
