"""Stops the robot's arm at once. Its argument is the stop word, in the folder of the domain:
python3 stop_arm.py "$XDG_RUNTIME_DIR/tabula/default/arm-stop"
"""
import os
import sys
import time

file = os.open(sys.argv[1], os.O_RDWR)
os.pwrite(file, time.monotonic_ns().to_bytes(8, sys.byteorder), 0)
