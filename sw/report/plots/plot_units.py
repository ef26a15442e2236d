#!/usr/bin/python3
import figures

figures.main("Frames per second and area against the number of column and window modules.", "units")
