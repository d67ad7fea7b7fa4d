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


#: A file of poses, and what is declared of it; nothing where it says all.
FILES = {
    "tum": (rows(lambda t, x, y, h: f"{t:.3f} {x} {y} 0 {turned(h)}"), ""),
    "tum with a head": (
        "# timestamp tx ty tz qx qy qz qw\n"
        + rows(lambda t, x, y, h: f"{t:.3f} {x} {y} 0 {turned(h)}"), ""),
    "degrees": (
        "time_s;x [m];y [m];yaw_deg\n"
        + rows(lambda t, x, y, h: f"{t:.3f};{x};{y};{np.degrees(h):.6f}"), ""),
    "clockwise": (
        "time_s,x_m,y_m,yaw_deg_cw\n"
        + rows(lambda t, x, y, h: f"{t:.3f},{x},{y},{-np.degrees(h):.6f}"), ""),
    "other units": (
        "pose_theta_rad,y [ft],pose x (cm),time_ms\n"
        + rows(lambda t, x, y, h: f"{h},{y / 0.3048:.6f},{100 * x},{1000 * t:.0f}"), ""),
    "rostopic": (
        "%time,field.header.stamp,field.pose.pose.position.x,field.pose.pose.position.y,"
        "field.pose.pose.orientation.x,field.pose.pose.orientation.y,field.pose.pose.orientation.z,"
        "field.pose.pose.orientation.w,field.twist.twist.linear.x,field.twist.twist.linear.y\n"
        + rows(lambda t, x, y, h: (
            f"7,{int(t)}000000000,{x},{y},{turned(h).replace(' ', ',')},0.5,0.6")), ""),
    "ros2": (
        rows(lambda t, x, y, h: (
            f"{int(t)},0,odom,base_link,{x},{y},0,{turned(h).replace(' ', ',')}{',0' * 80}")), ""),
    "plotjuggler": (
        "__time,/odom/pose/pose/position/x,/odom/pose/pose/position/y,"
        + ",".join(f"/odom/pose/pose/orientation/{axis}" for axis in "xyzw") + "\n"
        + rows(lambda t, x, y, h: f"{t:.3f},{x},{y},{turned(h).replace(' ', ',')}"), ""),
    "dates": (
        "Timestamp,x_m,y_m,theta_rad\n"
        + rows(lambda t, x, y, h: f"2020-09-13T12:26:{40 + t - 1.6e9:02.0f}Z,{x},{y},{h}"), ""),
    "no names": (rows(lambda t, x, y, h: f"{t:.3f},{x},{y},{h}"), "time_s,x_m,y_m,theta_rad"),
    "decimal commas": (
        "t;x;y;yaw\n" + rows(lambda t, x, y, h: f"{t:.3f};{x};{y};{h}").replace(".", ","),
        "time_s,x_m,y_m,theta_rad"),
    "another pose": (
        "time,target_x,target_y,x,y,theta\n"
        + rows(lambda t, x, y, h: f"{t:.3f},9,9,{x},{y},{h}"), "time_s,-*2,x_m,y_m,theta_rad"),
    "euroc": (
        "#timestamp [ns],p_RS_R_x [m],p_RS_R_y [m],q_RS_w [],q_RS_x [],q_RS_y [],q_RS_z []\n"
        + rows(lambda t, x, y, h: (
            f"{int(t)}000000000,{x},{y},{np.cos(h / 2)},0,0,{np.sin(h / 2)}")),
        "time_ns,x_m,y_m,qw,qx,qy,qz"),
}  # fmt: skip


@pytest.mark.parametrize("name", FILES)
def test_poses_are_read_by_what_their_columns_are(tmp_path, name):
    """Catches a column that is another, a quaternion in another order, and a guessed unit."""
    (path := tmp_path / "it.txt").write_text(FILES[name][0])
    columns = FILES[name][1]
    if columns:
        with pytest.raises(LogError, match=r"is not said|no name says") as caught:
            readers.read_trajectory(path)
        assert "read_trajectory('it.txt', columns='" in caught.value.reason
        beside = path.with_name("it.txt.toml")
        beside.write_text(f"columns = {columns!r}\n")
        assert readers.read_trajectory(path)[1] == pytest.approx(POSES, abs=1e-5)
        beside.unlink()
    times, poses = readers.read_trajectory(path, columns=columns or None)
    assert times == pytest.approx(TIMES) and poses == pytest.approx(POSES, abs=1e-5)


def test_a_head_of_two_poses_is_refused(tmp_path):
    """Catches the estimate that is read as the truth, or the other way."""
    (tmp_path / "it.csv").write_text("t,gt_x,gt_y,gt_yaw,est_x,est_y,est_yaw\n1,0,0,0,9,9,9\n")
    with pytest.raises(LogError, match=r"no name says which column is the pose_x"):
        readers.read_trajectory(tmp_path / "it.csv")


def test_poses_are_odometry_and_truth_at_the_times_of_the_scans(tmp_path):
    """Catches poses by their number, and those that are made up beside what the file covers."""
    path = tmp_path / "it.tum"
    path.write_text(FILES["tum"][0])
    shots = [segmap.LaserScan([1.0], [0.0], time=t) for t in (TIMES[0] + 0.5, TIMES[2] + 0.1)]
    log = readers.with_trajectories(segmap.Log("it", shots), odometry=path, truth=path)
    for found in (log.odometry, log.truth):
        assert found[0] == pytest.approx([0.5, 1.5, 0.3]) and np.isnan(found[1]).all()
    assert log.assumed == ("poses of it.tum are the robot's",)
    late = segmap.Log("it", [segmap.LaserScan([1.0], [0.0], time=5.0)])
    with pytest.raises(LogError, match="it has another clock"):
        readers.with_trajectories(late, truth=path)
    with pytest.raises(LogError, match="the scans of the log have no times"):
        readers.with_trajectories(
            segmap.Log("it", [segmap.LaserScan([1], [0], np.nan)]), truth=path
        )
