#!/usr/bin/python3
import figures

figures.main("Frames per second and area against the disparities.", "disparities")
