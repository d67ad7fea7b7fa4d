"""The lines of a backbone, and how a scan is laid on them."""

from matplotlib.axes import Axes

from ..alignment import BackboneStep
from ..plotting import ERROR, MAP, RESULT, axes_or_new, draw_robot, draw_segments, map_axes
from ..poses import transform


def draw_backbone(step: BackboneStep, *, ax: Axes | None = None) -> Axes:
    """Draw what the backbone method did with one scan.

    The lines of the backbone are black and dashed, the relevant segments as odometry would lay them
    red, as they were laid blue; the robot stands where it was laid.

    Parameters
    ----------
    step : BackboneStep
        From `alignment.backbone_steps`.
    ax : matplotlib Axes or None

    Returns
    -------
    Axes

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> from segmap import load
    >>> from segmap.alignment import backbone_steps
    >>> step = backbone_steps(load("corridor")[:2])[1]
    >>> len(draw_backbone(step, ax=Figure().subplots()).lines) == len(step.lines.angle)
    True
    """
    ax = axes_or_new(ax)
    draw_segments(transform(step.guess, step.segments), ax=ax, color=ERROR, width=1.0)
    draw_segments(transform(step.pose, step.segments), ax=ax, color=RESULT, width=2.5)
    map_axes(draw_robot(ax, step.pose))
    x, y = ax.get_xlim(), ax.get_ylim()
    along = step.lines.normal[:, ::-1] * (1, -1)
    for place, d in zip(step.lines.through, along, strict=True):
        ax.axline(tuple(place), tuple(place + d), color=MAP, linewidth=0.7, linestyle="--")
    ax.set(xlim=x, ylim=y)
    return ax
