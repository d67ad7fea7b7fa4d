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
    "other units": "time_ms,x_cm,y [ft],heading (deg)\n"
    + rows(lambda t, x, y, h: f"{1000 * t:.0f},{100 * x},{y / 0.3048:.6f},{np.degrees(h):.6f}"),
    "units below": "t;x;y;theta\n[s];[cm];[cm];[deg]\n"
    + rows(lambda t, x, y, h: f"{t};{100 * x};{100 * y};{np.degrees(h):.6f}"),
    "rostopic": "%time,field.header.stamp,field.pose.pose.position.x,field.pose.pose.position.y,"
    "field.pose.pose.orientation.x,field.pose.pose.orientation.y,field.pose.pose.orientation.z,"
    "field.pose.pose.orientation.w,field.twist.twist.linear.x,field.twist.twist.linear.y\n"
    + rows(lambda t, x, y, h: f"7,{int(t)}000000000,{x},{y},{turned(h).replace(' ', ',')},0.5,0.6"),
    "ros2": rows(
        lambda t, x, y, h: (
            f"{int(t)},0,odom,base_link,{x},{y},0,{turned(h).replace(' ', ',')}{',0' * 80}"
        )
    ),
    "plotjuggler": "__time,/odom/pose/position/x,/odom/pose/position/y,/odom/pose/theta\n"
    + rows(lambda t, x, y, h: f"{t:.3f},{x},{y},{h}"),
    "another pose": "time,target_x,target_y,x,y,theta\n"
    + rows(lambda t, x, y, h: f"{t:.3f},9,9,{x},{y},{h}"),
    "roll, pitch, yaw": rows(lambda t, x, y, h: f"{t:.3f} {x} {y} 0.02 0.01 0.03 {h}"),
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


def test_headings_that_jump_by_more_than_a_turn_are_degrees_and_told(tmp_path):
    """Catches degrees that are read as radians, and radians that count turns read as degrees."""
    path, degrees = tmp_path / "it.csv", (np.arange(30) * 33.0) % 360
    path.write_text("t,x,y,theta\n" + text(f"{k},0,0,{a}" for k, a in enumerate(degrees)))
    assert readers.read_trajectory(path)[1][:, 2] == pytest.approx(np.radians(degrees))
    log = segmap.Log("it", [segmap.LaserScan([1.0], [0.0], time=3.0)])
    assert "headings are in degrees" in readers.with_trajectories(log, truth=path).assumed[0]
    path.write_text("t,x,y,theta\n" + text(f"{k},0,0,{0.5 * k}" for k in range(30)))
    assert readers.read_trajectory(path)[1][-1, 2] == pytest.approx(14.5)


def test_a_head_of_two_poses_is_refused(tmp_path):
    """Catches the estimate that is read as the truth, or the other way."""
    (tmp_path / "it.csv").write_text("t,gt_x,gt_y,gt_yaw,est_x,est_y,est_yaw\n1,0,0,0,9,9,9\n")
    with pytest.raises(LogError, match=r"several poses \(gt_x, est_x\)"):
        readers.read_trajectory(tmp_path / "it.csv")


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
    for content, said in (
        ("a,b\n", "13 columns of ground truth"),
        ("", "holds no pose"),
        ("1 0 0 2 0 1 0 3 0 0 1 0\n", "poses without times"),
    ):
        path.write_text(content)
        with pytest.raises(LogError, match=said):
            readers.read_trajectory(path)
