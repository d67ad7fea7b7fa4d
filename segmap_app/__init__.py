"""What serves people with a log: the command `segmap`, its page, and the files of other programs.

It is made of the library `segmap`, which does not need it. What a chapter teaches is in the
library; what no chapter teaches is here.
"""
