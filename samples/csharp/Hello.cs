// SPDX-License-Identifier: MIT
// Hello.exe ASSET.sphc PALETTES: which body parts are inside each other, frame by frame. The same lines as samples/hello.
using System;
using System.Globalization;
using System.IO;
using Spherechain;

public static class Hello
{
    static void Play(byte[] file, Palettes clip)
    {
        // [hello]
        // Your skeleton: names and inverse bind matrices. All memory is allocated here, never in a frame.
        using (Model model = new Model(file, clip.Joints, clip.InverseBinds, MatrixLayout.Columns4x4))
        using (Body body = new Body(model))
        {
            model.CheckRest(clip.Rest, MatrixLayout.Columns4x4);
            for (int frame = 0; frame < clip.Frames.Length; ++frame)
            {
                body.SetPose(clip.Frames[frame], MatrixLayout.Columns4x4);  // what your skinning shader gets
                foreach (Penetration found in body.Penetrations())  // faults alone: no folds at joints, no touches
                {
                    string joint = found.Joint == Native.NoJoint ? "nothing" : clip.Joints[found.Joint];
                    Print(frame, model, joint, found);
                }
            }
        }
        // [/hello]
    }

    static void Print(int frame, Model model, string joint, Penetration found)
    {
        Vec3 way = found.Direction;  // moved by Distance along it, the part is free
        Console.WriteLine("frame {0}: {1} in {2}, {3} mm; move {4} by ({5}, {6}, {7})", frame, model.PartName(found.Part),
                          model.PartName(found.Other), Number(model.Millimetres(found.Measures.Depth), "F0"), joint,
                          Number(found.Distance * way.X, "F3"), Number(found.Distance * way.Y, "F3"),
                          Number(found.Distance * way.Z, "F3"));
    }

    // As C prints it: with the sign of -0.00.
    static string Number(float value, string format)
    {
        bool isNegative = value < 0 || (value == 0 && 1 / value < 0);
        return (isNegative ? "-" : "") + Math.Abs((double)value).ToString(format, CultureInfo.InvariantCulture);
    }

    public static int Main(string[] arguments)
    {
        if (arguments.Length != 2)
        {
            Console.Error.WriteLine("usage: Hello.exe ASSET.sphc PALETTES");
            return 2;
        }
        try
        {
            Play(File.ReadAllBytes(arguments[0]), new Palettes(arguments[1]));
            return 0;
        }
        catch (Exception error) when (error is SpherechainException || error is IOException)
        {
            Console.Error.WriteLine("hello: error: " + error.Message);
            return 3;
        }
    }
}
